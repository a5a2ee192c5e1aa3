#include "read_job.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <busbar/binary/codec.hpp>

#include "core/fetch.hpp"
#include "server/rights/nodes_ahead.hpp"

namespace busbar::server::detail {

namespace {

/// A maxAge of the largest Int32 or more requests any available value (Part 4, 5.11.2.2).
std::chrono::milliseconds to_max_age(double milliseconds)
{
    return std::chrono::milliseconds{
        static_cast<std::int64_t>(std::min<double>(milliseconds, INT32_MAX))};
}

} // namespace

StatusCode check_read(const ReadRequest& request, std::size_t max_nodes)
{
    if (request.nodes_to_read.empty()) {
        return status::Bad_NothingToDo;
    }
    if (request.nodes_to_read.size() > max_nodes) {
        return status::Bad_TooManyOperations;
    }
    if (request.timestamps_to_return < TimestampsToReturn::Source ||
        request.timestamps_to_return > TimestampsToReturn::Neither) {
        return status::Bad_TimestampsToReturnInvalid;
    }
    // Also rejects a maxAge that is NaN.
    return request.max_age >= 0 ? status::Good : status::Bad_MaxAgeInvalid;
}

ReadJob::ReadJob(DataSources& sources, const ReadRequest& request, std::size_t max_response)
    : request_{request}, call_{sources, request.nodes_to_read.size()},
      timestamps_{request.timestamps_to_return, DateTime{}}, max_age_{to_max_age(request.max_age)},
      sink_{max_response}, writer_{sink_}
{
}

bool ReadJob::plan(const ReadContext& context, Turn& turn)
{
    timestamps_ = {request_.timestamps_to_return, context.server_time};
    rebindings_ = context.space.journal().rebindings();
    const auto ids = request_.nodes_to_read.span();
    NodesAhead nodes{context.space, context.registered};
    do {
        const model::NodeIndex node = nodes.find(
            ids, planned_, [](const ReadValueId& id) -> const NodeId& { return id.node_id; });
        const std::size_t before = writer_.written();
        plan_one(context, planned_, node);
        turn.spend(Turn::units_of_value + writer_.written() - before + std::exchange(cut_, 0));
        ++planned_;
    } while (planned_ < ids.size() && fits() && !turn.is_over());
    return planned_ == ids.size() || !fits();
}

void ReadJob::take_answer(std::size_t index, DataValue answer, const NumericRange* range)
{
    ReadSlot slot;
    static_cast<DataValue&>(slot) = std::move(answer);
    if (range != nullptr) {
        cut_ = binary::encoded_size(slot.value);
        cut_range(slot, *range);
        ranges_->pop_back();
    }
    const std::size_t before = writer_.written();
    const StatusCode status = encode_slot(writer_, slot, timestamps_);
    encoded_.push_back({static_cast<std::uint32_t>(index),
                        static_cast<std::uint32_t>(writer_.written() - before), status});
}

void ReadJob::plan_one(const ReadContext& context, std::size_t index, model::NodeIndex node)
{
    const ReadValueId& id = request_.nodes_to_read[index];
    ReadPlan planned = plan_read(context, id, node);
    if (planned.answer.status.is_bad()) {
        call_.answer(index).status = planned.answer.status;
        return;
    }
    const Result<NumericRange*> range = keep_range(index, id.index_range);
    if (!range) {
        call_.answer(index).status = range.error();
        return;
    }
    if (planned.source == nullptr) {
        return take_answer(index, std::move(planned.answer), *range);
    }
    const bool is_cut_by_source = *range != nullptr && planned.source->options().reads_ranges;
    if (is_cut_by_source) {
        ranges_->back().is_cut_here = false;
    }
    call_.ask(index, planned.source_index, {planned.handle, is_cut_by_source ? *range : nullptr});
}

Result<NumericRange*> ReadJob::keep_range(std::size_t index, const String& text)
{
    if (text.empty()) {
        return nullptr;
    }
    auto range = NumericRange::parse(text.view());
    if (!range) {
        return fail(range.error());
    }
    if (ranges_ == nullptr) {
        ranges_ = std::make_shared<std::vector<Range>>();
        // It must not move, since sources get its addresses.
        ranges_->reserve(call_.size() - index);
    }
    return &ranges_->emplace_back(Range{*range, index, true}).range;
}

bool ReadJob::start(SourceCallOwner& owner, TimePoint now)
{
    call_.kept_for_sources() = ranges_;
    return call_.start(owner, now, [&](ReadPart& part) { part.max_age = max_age_; });
}

void ReadJob::finish()
{
    if (ranges_ == nullptr) {
        return;
    }
    for (const Range& range : *ranges_) {
        ReadSlot* const slot = range.is_cut_here ? call_.find_answer(range.index) : nullptr;
        if (slot != nullptr) {
            cut_range(*slot, range.range);
        }
    }
}

Array<DiagnosticInfo> ReadJob::diagnose(ReturnDiagnostics& diagnostics) const
{
    if (!diagnostics.wants_operations()) {
        return {};
    }
    std::vector<StatusCode> all(call_.size());
    auto next = encoded_.begin();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool is_encoded = next != encoded_.end() && next->index == i;
        all[i] = is_encoded ? next++->status : served_status(call_.result(i));
    }
    return diagnostics.of_operations(
        all.size(), [&](std::size_t i) { return all[i]; },
        [&](std::size_t i) { return operand_text(request_, i); });
}

void ReadJob::encode_results(binary::Writer& writer, DateTime answered,
                             const Array<DiagnosticInfo>& infos)
{
    const std::vector<std::byte> bytes = sink_.take(writer_.written());
    std::span<const std::byte> rest{bytes};
    auto next = encoded_.begin();
    writer.length(call_.size());
    for (std::size_t i = 0; i < call_.size(); ++i) {
        if (const std::size_t ahead = i + busbar::detail::fetched_ahead; ahead < call_.size()) {
            busbar::detail::fetch(call_.result(ahead).shared);
        }
        if (next != encoded_.end() && next->index == i) {
            writer.bytes(rest.first(next->size));
            rest = rest.subspan(next->size);
            ++next;
        } else {
            const ReadSlot& slot = call_.result(i);
            encode_slot(writer, slot, timestamps_.of_answer(slot.source_timestamp, answered));
        }
    }
    encode(writer, infos);
}

} // namespace busbar::server::detail
