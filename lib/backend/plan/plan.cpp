#include <busbar/backend/plan.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

#include "backend/plan/state.hpp"

namespace busbar::backend {

namespace {

using detail::never_good;
using detail::PlanBatch;
using detail::PlanJob;
using detail::PlanPart;
using detail::words_of;

/// Writes that may be sent one after the other while a read waits.
constexpr std::size_t max_writes_in_a_row = 8;

} // namespace

RequestPlan::RequestPlan(PlanConfig config) : impl_{std::make_unique<Impl>(std::move(config))} {}

RequestPlan::RequestPlan(RequestPlan&&) noexcept = default;
RequestPlan& RequestPlan::operator=(RequestPlan&&) noexcept = default;
RequestPlan::~RequestPlan() = default;

Result<std::uint64_t> RequestPlan::read(std::span<const PlanAddress> addresses, TimePoint now)
{
    if (!impl_->has_room(addresses.size())) {
        return busbar::fail(status::Bad_TooManyOperations);
    }
    PlanBatch batch;
    batch.result.values.resize(addresses.size());
    std::size_t words = 0;
    for (std::size_t i = 0; i < addresses.size(); ++i) {
        const auto rule = impl_->admit(batch, addresses[i], i, words);
        if (!rule) {
            return busbar::fail(rule.error());
        }
        if (*rule != nullptr) {
            PlanPart part{.address = addresses[i], .group = (*rule)->read.group};
            part.index = static_cast<std::uint32_t>(i);
            part.first_word = batch.result.values[i].first_word;
            impl_->add_read(batch, part, **rule, now);
        }
    }
    batch.result.words.resize(words);
    detail::sort_parts(batch.parts);
    auto jobs = impl_->lay_out(batch, 0, batch.parts.size(), now);
    return impl_->begin(std::move(batch), std::move(jobs));
}

Result<std::uint64_t> RequestPlan::write(std::span<const PlanWrite> writes)
{
    if (!impl_->has_room(writes.size())) {
        return busbar::fail(status::Bad_TooManyOperations);
    }
    PlanBatch batch;
    batch.result.is_write = true;
    batch.result.values.resize(writes.size());
    std::size_t words = 0;
    for (std::size_t i = 0; i < writes.size(); ++i) {
        const PlanWrite& write = writes[i];
        const auto rule = impl_->admit(batch, write.address, i, words);
        if (!rule) {
            return busbar::fail(rule.error());
        }
        if (*rule == nullptr) {
            continue;
        }
        PlanValue& value = batch.result.values[i];
        const bool fits = write.words.size() == value.word_count &&
                          (write.mask == 0xFFFF || value.word_count == 1);
        if (!fits) {
            words = value.first_word;
            value = {.status = status::Bad_ConfigurationError};
            continue;
        }
        PlanPart part{.address = write.address};
        part.index = static_cast<std::uint32_t>(i);
        part.first_word = value.first_word;
        part.mask = write.mask;
        batch.to_write.insert(batch.to_write.end(), write.words.begin(), write.words.end());
        detail::append_pieces(batch.parts, part, (*rule)->max_write,
                              std::max((*rule)->words_per_unit, 1U));
    }
    auto jobs = impl_->lay_out(batch, 0, batch.parts.size(), {});
    return impl_->begin(std::move(batch), std::move(jobs));
}

void RequestPlan::cancel(std::uint64_t number)
{
    const auto batch = impl_->batches.find(number);
    if (batch == impl_->batches.end()) {
        return;
    }
    impl_->addresses -= batch->second.result.values.size();
    impl_->words -= words_of(batch->second.result);
    std::erase(impl_->reads, number);
    std::erase(impl_->writes, number);
    impl_->batches.erase(batch);
}

std::optional<PlanRequest> RequestPlan::next_request()
{
    if (impl_->sent.size() >= std::max<std::size_t>(impl_->config.max_under_way, 1)) {
        return std::nullopt;
    }
    const bool is_turn_of_reads =
        !impl_->reads.empty() && impl_->writes_in_a_row >= max_writes_in_a_row;
    if (!impl_->is_writing && !is_turn_of_reads) {
        if (auto request = impl_->next_write()) {
            ++impl_->writes_in_a_row;
            return request;
        }
    }
    if (impl_->reads.empty()) {
        return std::nullopt;
    }
    impl_->writes_in_a_row = 0;
    return impl_->next_read();
}

void RequestPlan::answer(std::uint64_t request, std::span<const std::uint16_t> words, TimePoint now)
{
    const auto sent = impl_->take_sent(request);
    if (!sent) {
        return;
    }
    PlanBatch& batch = impl_->batches.at(sent->batch);
    const bool is_complete = sent->is_write || impl_->take_words(batch, sent->job, words);
    if (is_complete) {
        impl_->note_access(batch, sent->job, request);
    } else {
        batch.set_status(sent->job, status::Bad_DecodingError);
    }
    impl_->settle(batch, *sent, is_complete, now);
    impl_->finish_if_done(sent->batch);
}

void RequestPlan::refuse(std::uint64_t request, StatusCode status, TimePoint now,
                         std::uint16_t code)
{
    const auto sent = impl_->take_sent(request);
    if (!sent) {
        return;
    }
    PlanBatch& batch = impl_->batches.at(sent->batch);
    const PlanJob& job = sent->job;
    const std::size_t middle = detail::divide(batch.parts, job.begin, job.end);
    if (middle != job.end && batch.isolating_left >= 2) {
        impl_->divide(batch, *sent, middle, now);
    } else {
        batch.set_status(job, status, code);
        if (middle == job.end && !sent->is_write) {
            impl_->memory.refused(batch.parts[job.begin].address,
                                  {never_good(status), now + impl_->config.refusal_memory, code},
                                  now);
        }
    }
    impl_->settle(batch, *sent, false, now);
    impl_->finish_if_done(sent->batch);
}

void RequestPlan::plan_again(std::uint64_t request, TimePoint now)
{
    auto sent = impl_->take_sent(request);
    if (!sent) {
        return;
    }
    PlanBatch& batch = impl_->batches.at(sent->batch);
    if (sent->rules == impl_->rules.version()) {
        batch.set_status(sent->job, status::Bad_NotSupported);
        impl_->settle(batch, *sent, false, now);
    } else {
        auto jobs = impl_->lay_out_again(batch, std::move(sent->job), now);
        batch.waiting.insert(batch.waiting.begin(), std::make_move_iterator(jobs.begin()),
                             std::make_move_iterator(jobs.end()));
        impl_->give_turn(sent->batch, batch);
    }
    impl_->finish_if_done(sent->batch);
}

void RequestPlan::fail(std::uint64_t request, StatusCode status)
{
    const auto sent = impl_->take_sent(request);
    if (!sent) {
        return;
    }
    PlanBatch& batch = impl_->batches.at(sent->batch);
    batch.set_status(sent->job, status);
    impl_->settle(batch, *sent, false, {});
    impl_->finish_if_done(sent->batch);
}

void RequestPlan::fail_all(StatusCode status)
{
    for (const auto& [request, sent] : impl_->sent) {
        const auto batch = impl_->batches.find(sent.batch);
        if (batch != impl_->batches.end()) {
            batch->second.set_status(sent.job, status);
        }
    }
    impl_->sent.clear();
    impl_->reads.clear();
    impl_->writes.clear();
    impl_->is_writing = false;
    while (!impl_->batches.empty()) {
        const auto batch = impl_->batches.begin();
        for (const PlanJob& job : batch->second.waiting) {
            batch->second.set_status(job, status);
        }
        impl_->finish(batch);
    }
}

std::optional<PlanResult> RequestPlan::next_result()
{
    if (impl_->results.empty()) {
        return std::nullopt;
    }
    PlanResult result = std::move(impl_->results.front());
    impl_->results.pop_front();
    impl_->addresses -= result.values.size();
    impl_->words -= words_of(result);
    return result;
}

std::size_t RequestPlan::under_way() const
{
    return impl_->sent.size();
}

bool RequestPlan::has_waiting() const
{
    return !impl_->reads.empty() || (!impl_->is_writing && !impl_->writes.empty());
}

const PlanCounters& RequestPlan::counters() const
{
    return impl_->counters;
}

void RequestPlan::change_rules(std::span<const PlanRule> rules, std::size_t max_under_way,
                               TimePoint now)
{
    impl_->rules.change(rules);
    impl_->config.max_under_way = max_under_way;
    for (auto& [number, batch] : impl_->batches) {
        for (auto& job : std::exchange(batch.waiting, {})) {
            auto jobs = impl_->lay_out_again(batch, std::move(job), now);
            std::move(jobs.begin(), jobs.end(), std::back_inserter(batch.waiting));
        }
    }
}

void RequestPlan::forget_refusals()
{
    impl_->memory.forget();
}

} // namespace busbar::backend