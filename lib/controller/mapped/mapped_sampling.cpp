#include "mapped_sampling.hpp"

#include <algorithm>

namespace busbar::controller::detail {

using backend::LabelRequest;
using backend::LabelStatus;

namespace {

bool is_wanted(SamplingMode mode, const MappedTable::Variable& variable)
{
    return variable.shape != nullptr && !variable.is_broken && variable.is_readable &&
           (mode == SamplingMode::AllVariables || variable.interval.has_value());
}

void report(const MappedContext& context, MappedErrorCode code)
{
    if (context.observer == nullptr) {
        return;
    }
    const MappedTable& table = context.table;
    bool has_named = false;
    for (const MappedTable::Variable& variable : table.variables()) {
        if (code != MappedErrorCode::UnsampledDevice ||
            variable.sampled_at == MappedTable::not_sampled) {
            continue;
        }
        for (const MappedLeaf& leaf :
             table.leaves().subspan(variable.range.first, variable.range.count)) {
            if (leaf.is_unsampled_device) {
                context.observer->error({code, table.name_of(leaf), &table.node_of(leaf)});
                has_named = true;
            }
        }
    }
    if (!has_named) {
        context.observer->error({code});
    }
}

} // namespace

std::unique_ptr<LabelRequest> MappedSampling::change(MappedContext& context)
{
    auto request = std::make_unique<LabelRequest>();
    request->kind = LabelRequest::Kind::Sample;
    LeafRange all;
    bool is_too_much = false;
    for (MappedTable::Variable& variable : context.table.variables()) {
        variable.sampled_at = MappedTable::not_sampled;
        if (is_too_much || !is_wanted(context.options.sampling, variable)) {
            continue;
        }
        all.count += static_cast<std::uint32_t>(variable.count());
        all.words += variable.words();
        is_too_much = !is_within({}, all.count, all.words);
        if (!is_too_much) {
            variable.sampled_at = static_cast<std::uint32_t>(request->bytes.size());
            context.table.add_places(variable, *request);
        }
    }
    size_ = request->bytes.size();
    scan_ = 0;
    scan_interval_ = Duration::zero();
    if (is_too_much) {
        state_ = State::Failed;
        report(context, MappedErrorCode::TooManyPoints);
        return nullptr;
    }
    if (request->places.empty() && !has_asked_) {
        state_ = State::Off;
        return nullptr;
    }
    has_asked_ = !request->places.empty();
    state_ = State::Changing;
    return request;
}

void MappedSampling::changed(MappedContext& context, const LabelRequest& request)
{
    state_ = State::Failed;
    switch (request.status) {
    case LabelStatus::Done:
        state_ = has_asked_ ? State::On : State::Off;
        break;
    case LabelStatus::TooManyPoints:
        report(context, MappedErrorCode::TooManyPoints);
        break;
    case LabelStatus::UnsampledDevice:
        report(context, MappedErrorCode::UnsampledDevice);
        break;
    case LabelStatus::SamplingUnknown:
        report(context, MappedErrorCode::SamplingUnsupported);
        break;
    default:
        state_ = State::Off; // the next batch requests sampling again
        break;
    }
}

bool MappedSampling::look(backend::LabelBackend& backend)
{
    bytes_.resize(size_);
    DateTime time;
    const std::uint64_t scan = backend.sampled(bytes_, time);
    if (scan == 0) {
        return false;
    }
    if (scan_ != 0 && scan > scan_) {
        // 100 ns each.
        const auto ticks = (time.ticks - time_.ticks) / static_cast<std::int64_t>(scan - scan_);
        scan_interval_ = std::chrono::nanoseconds{std::max<std::int64_t>(ticks, 0) * 100};
    }
    scan_ = scan;
    time_ = time;
    return true;
}

bool MappedSampling::has_all(MappedContext& context, const server::ReadBatch& batch)
{
    return std::all_of(
        batch.items().begin(), batch.items().end(), [&](const server::ReadItem& item) {
            const auto* const variable = context.table.variable(item.handle);
            return variable == nullptr || variable->shape == nullptr || variable->is_broken ||
                   variable->sampled_at != MappedTable::not_sampled;
        });
}

bool MappedSampling::answer(MappedContext& context, backend::LabelBackend& backend,
                            server::ReadBatch& batch)
{
    if (state_ != State::On || !has_all(context, batch) || !look(backend)) {
        return false;
    }
    const ValueReader reader{context, bytes_.data(), time_};
    for (std::size_t i = 0; i < batch.size(); ++i) {
        auto* const variable = context.table.variable(batch.items()[i].handle);
        if (variable == nullptr) {
            continue;
        }
        server::ReadSlot& slot = batch.results()[i];
        const bool has_bytes = variable->shape != nullptr && !variable->is_broken;
        const std::size_t offset = has_bytes ? variable->sampled_at : 0;
        if (!reader.read(*variable, offset, slot)) {
            batch.fail(status::Bad_NoCommunication);
            return true;
        }
        // Standard sampling allows 5 % more, high-speed sampling does not (8.3).
        const bool is_overload = variable->interval && scan_interval_ > *variable->interval;
        if (is_overload && slot.status.is_good()) {
            slot.status = status::Good_Overload;
        }
    }
    ValueReader::keep(context.table, batch);
    batch.complete();
    return true;
}

} // namespace busbar::controller::detail
