#include "read_job.hpp"

#include <algorithm>
#include <cmath>

#include <busbar/binary/codec.hpp>

namespace busbar::server::detail {

namespace {

/// A maxAge of the largest Int32 or more asks for any value that is there (Part 4, 5.11.2.2).
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
    // Also true of a maxAge that is not a number.
    return request.max_age >= 0 ? status::Good : status::Bad_MaxAgeInvalid;
}

ReadJob::ReadJob(const ReadContext& context, const ReadRequest& request)
    : call_{context.sources, request.nodes_to_read.size()}, room_{context.max_response},
      timestamps_{request.timestamps_to_return, context.server_time}, max_age_{to_max_age(
                                                                          request.max_age)}
{
    const auto ids = request.nodes_to_read.span();
    for (std::size_t i = 0; i < ids.size() && fits(); ++i) {
        plan(context, i, ids[i]);
    }
}

/// One value may be asked for many times in one small request, of which each takes its own copy.
void ReadJob::take_answer(std::size_t index, DataValue answer, const NumericRange* range)
{
    ReadSlot& slot = call_.answer(index);
    static_cast<DataValue&>(slot) = std::move(answer);
    if (range != nullptr) {
        cut_range(slot, *range);
        ranges_->pop_back();
    }
    room_ -= std::min(room_, binary::encoded_size(slot.value));
}

void ReadJob::plan(const ReadContext& context, std::size_t index, const ReadValueId& id)
{
    ReadPlan planned = plan_read(context, id);
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
        // It must not move: sources are given the addresses.
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

void ReadJob::encode_results(binary::Writer& writer) const
{
    writer.length(call_.size());
    for (std::size_t i = 0; i < call_.size(); ++i) {
        encode_slot(writer, call_.result(i), timestamps_);
    }
    encode(writer, Array<DiagnosticInfo>{});
}

} // namespace busbar::server::detail
