#include <utility>

#include "mapped_operation.hpp"

namespace busbar::controller::detail {

bool is_within(const MappedLimits& limits, std::size_t labels, std::size_t words)
{
    // Offsets in a request have 32 bits, and a word may take two bytes.
    constexpr std::size_t most = UINT32_MAX / 2 - 1;
    return labels <= limits.max_labels && words <= limits.max_words && words <= most;
}

bool ValueReader::read(MappedTable::Variable& variable, std::size_t offset,
                       server::ReadSlot& slot) const
{
    if (variable.shape == nullptr) {
        slot = DataValue{status::Bad_NotSupported};
        return true;
    }
    if (variable.is_broken) {
        slot = DataValue{status::Bad_NoCommunication};
        return true;
    }
    const StatusCode quality = context_.table.quality_of(variable, bytes_ + offset);
    if (quality.is_bad()) {
        slot = DataValue{quality};
        slot.source_timestamp = time_;
        return true;
    }
    const MappedLeaf* culprit = nullptr;
    auto value = context_.table.decode(*variable.shape, variable.range, bytes_ + offset,
                                       &variable.kept, &culprit);
    if (value) {
        slot.value = std::move(*value);
        slot.status = quality;
        slot.source_timestamp = time_;
        return true;
    }
    if (culprit != nullptr && context_.observer != nullptr) {
        context_.observer->error({MappedErrorCode::OutOfRange, context_.table.name_of(*culprit),
                                  &context_.table.node_of(*culprit)});
    }
    slot = DataValue{status::Bad_NoCommunication};
    return context_.options.isolates_failures;
}

void ValueReader::keep(MappedTable& table, server::ReadBatch& batch)
{
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const server::ReadSlot& slot = batch.results()[i];
        auto* const variable = table.variable(batch.items()[i].handle);
        if (variable != nullptr && !slot.status.is_bad()) {
            variable->kept = slot.value;
            variable->time = slot.source_timestamp;
        }
    }
}

namespace {

class Read final : public MappedOperation {
public:
    explicit Read(server::ReadBatch batch) : batch_{std::move(batch)}
    {
        waits_for_room = batch_.is_sample();
    }

    std::unique_ptr<backend::LabelRequest> next(MappedContext& context) override;
    void done(MappedContext& context, const backend::LabelRequest& request) override;
    void fail(MappedContext&, StatusCode status) override
    {
        batch_.fail(status);
        is_answered_ = true;
    }

private:
    [[nodiscard]] bool fill(MappedContext& context, const std::byte* bytes, DateTime time);

    server::ReadBatch batch_;
    bool is_answered_{false};
};

std::unique_ptr<backend::LabelRequest> Read::next(MappedContext& context)
{
    if (is_answered_) {
        return nullptr;
    }
    LeafRange all;
    for (const server::ReadItem& item : batch_.items()) {
        const auto* const variable = context.table.variable(item.handle);
        if (variable != nullptr && !variable->is_broken) {
            all.count += static_cast<std::uint32_t>(variable->count());
            all.words += variable->words();
        }
    }
    if (!is_within(context.options.limits, all.count, all.words)) {
        fail(context, status::Bad_NoCommunication);
        return nullptr;
    }
    if (all.count == 0) {
        if (fill(context, nullptr, DateTime{})) {
            batch_.complete();
        }
        return nullptr;
    }
    auto request = std::make_unique<backend::LabelRequest>();
    request->kind = backend::LabelRequest::Kind::Read;
    request->places.reserve(all.count);
    request->bytes.reserve(2 * all.words);
    for (const server::ReadItem& item : batch_.items()) {
        const auto* const variable = context.table.variable(item.handle);
        if (variable != nullptr && !variable->is_broken) {
            context.table.add_places(*variable, *request);
        }
    }
    return request;
}

bool Read::fill(MappedContext& context, const std::byte* bytes, DateTime time)
{
    const ValueReader reader{context, bytes, time};
    std::size_t offset = 0;
    for (std::size_t i = 0; i < batch_.size(); ++i) {
        auto* const variable = context.table.variable(batch_.items()[i].handle);
        if (variable == nullptr) {
            continue; // its slot has Bad_NoCommunication
        }
        if (!reader.read(*variable, offset, batch_.results()[i])) {
            return false;
        }
        offset += variable->bytes();
    }
    return true;
}

void Read::done(MappedContext& context, const backend::LabelRequest& request)
{
    // One value out of range fails the whole batch (8.3, Operation when processing fails).
    if (!fill(context, request.bytes.data(), request.time)) {
        return fail(context, status::Bad_NoCommunication);
    }
    ValueReader::keep(context.table, batch_);
    batch_.complete();
    is_answered_ = true;
}

} // namespace

std::unique_ptr<MappedOperation> make_read(server::ReadBatch batch)
{
    return std::make_unique<Read>(std::move(batch));
}

} // namespace busbar::controller::detail
