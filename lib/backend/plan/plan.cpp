#include <busbar/backend/plan.hpp>

#include <algorithm>
#include <deque>
#include <map>
#include <utility>

#include "backend/plan/layout.hpp"
#include "backend/plan/memory.hpp"

namespace busbar::backend {

namespace {

using detail::no_division;
using detail::PlanJob;
using detail::PlanPart;

/// Writes that may be sent one after the other while a read waits.
constexpr std::size_t max_writes_in_a_row = 8;

StatusCode never_good(StatusCode status)
{
    return status.is_good() ? StatusCode{status::Bad_UnexpectedError} : status;
}

/// A refused request that was planned again in parts.
struct Division {
    /// The first address of the second half.
    PlanAddress second{};
    std::size_t unanswered{0};
    bool is_accepted{true};
};

struct Batch {
    PlanResult result{};
    /// Sorted for a read, in the order of the addresses for a write.
    std::vector<PlanPart> parts{};
    /// The words of a write, in the order of the addresses.
    std::vector<std::uint16_t> to_write{};
    std::deque<PlanJob> waiting{};
    std::vector<Division> divisions{};
    std::size_t under_way{0};
    /// Requests that may still be added to find refused addresses.
    std::size_t isolating_left{0};
    /// It is in the list of those that have something to send.
    bool has_turn{false};

    void set_status(const PlanJob& job, StatusCode status)
    {
        for (std::size_t at = job.begin; at < job.end; ++at) {
            StatusCode& present = result.values[parts[at].index].status;
            present = present.is_good() ? never_good(status) : present;
        }
    }
};

/// A request that is under way.
struct Sent {
    std::uint64_t batch{0};
    bool is_write{false};
    PlanJob job{};
};

std::size_t words_of(const PlanResult& result)
{
    std::size_t words = 0;
    for (const PlanValue& value : result.values) {
        words += value.word_count;
    }
    return words;
}

} // namespace

struct RequestPlan::Impl {
    explicit Impl(PlanConfig given)
        : config{std::move(given)}, rules{std::move(config.rules)}, memory{config.max_remembered}
    {
    }

    /// Makes place for an address and returns its rule; null if no request can have it.
    [[nodiscard]] Result<const PlanRule*> admit(Batch& batch, const PlanAddress& address,
                                                std::size_t index, std::size_t& words) const;
    void add_read(Batch& batch, PlanPart part, const PlanRule& rule, TimePoint now);
    [[nodiscard]] bool has_room(std::size_t more_addresses) const;
    [[nodiscard]] std::uint64_t begin(Batch batch, std::vector<PlanJob> jobs);

    [[nodiscard]] std::optional<PlanRequest> next_write();
    [[nodiscard]] std::optional<PlanRequest> next_read();
    [[nodiscard]] PlanRequest send(std::uint64_t number, Batch& batch);

    /// Ends a request. None if it is not under way, or its batch was cancelled.
    [[nodiscard]] std::optional<Sent> take_sent(std::uint64_t request);
    /// Takes the words of a read; false if they are not as many as its ranges have.
    [[nodiscard]] bool take_words(Batch& batch, const PlanJob& job,
                                  std::span<const std::uint16_t> words);
    void note_access(Batch& batch, const PlanJob& job, std::uint64_t request);
    void divide(Batch& batch, const Sent& sent, std::size_t middle, TimePoint now);
    /// A request of a division has its answer.
    void settle(Batch& batch, const Sent& sent, bool is_accepted, TimePoint now);

    void give_turn(std::uint64_t number, Batch& batch);
    void finish_if_done(std::uint64_t number);
    void finish(std::map<std::uint64_t, Batch>::iterator batch);

    PlanConfig config;
    detail::PlanRules rules;
    detail::PlanMemory memory;
    std::map<std::uint64_t, Batch> batches{};
    /// Batches that have reads to send, by turns, and writes, in their order.
    std::deque<std::uint64_t> reads{};
    std::deque<std::uint64_t> writes{};
    std::map<std::uint64_t, Sent> sent{};
    std::deque<PlanResult> results{};
    std::uint64_t last_batch{0};
    std::uint64_t last_request{0};
    bool is_writing{false};
    std::size_t writes_in_a_row{0};
    /// Addresses and words of all batches, results included.
    std::size_t addresses{0};
    std::size_t words{0};
    PlanCounters counters{};
};

Result<const PlanRule*> RequestPlan::Impl::admit(Batch& batch, const PlanAddress& address,
                                                 std::size_t index, std::size_t& words_so_far) const
{
    PlanValue& value = batch.result.values[index];
    const PlanRule* const rule = rules.find(address.area);
    if (!detail::is_possible(address, rule)) {
        value.status = status::Bad_ConfigurationError;
        return nullptr;
    }
    const std::uint64_t count = std::uint64_t{address.width} * std::max(rule->words_per_unit, 1U);
    const std::size_t room = config.max_words - std::min(config.max_words, words + words_so_far);
    if (count > room) {
        return busbar::fail(status::Bad_TooManyOperations);
    }
    value.first_word = words_so_far;
    value.word_count = static_cast<std::size_t>(count);
    words_so_far += value.word_count;
    return rule;
}

bool RequestPlan::Impl::has_room(std::size_t more_addresses) const
{
    return batches.size() + results.size() < config.max_batches &&
           more_addresses <= config.max_addresses - std::min(addresses, config.max_addresses);
}

void RequestPlan::Impl::add_read(Batch& batch, PlanPart part, const PlanRule& rule, TimePoint now)
{
    const std::size_t first = batch.parts.size();
    const std::uint32_t max_width = rule.max_read - std::min(rule.max_read, rule.range_cost);
    detail::append_pieces(batch.parts, part, max_width, std::max(rule.words_per_unit, 1U));
    for (std::size_t at = first; at < batch.parts.size(); ++at) {
        const auto* const refusal = memory.refusal_of(batch.parts[at].address);
        if (refusal == nullptr) {
            continue;
        }
        batch.parts[at].is_alone = true;
        if (now < refusal->until) {
            batch.result.values[part.index].status = refusal->status;
            batch.parts.resize(first);
            ++counters.remembered;
        }
    }
}

std::uint64_t RequestPlan::Impl::begin(Batch batch, std::vector<PlanJob> jobs)
{
    const std::uint64_t number = ++last_batch;
    batch.result.batch = number;
    batch.isolating_left = config.max_isolating;
    batch.waiting.assign(std::make_move_iterator(jobs.begin()),
                         std::make_move_iterator(jobs.end()));
    addresses += batch.result.values.size();
    counters.addresses += batch.result.values.size();
    words += words_of(batch.result);
    Batch& kept = batches.emplace(number, std::move(batch)).first->second;
    if (kept.waiting.empty()) {
        finish_if_done(number);
    } else if (kept.result.is_write) {
        kept.has_turn = true;
        writes.push_back(number);
    } else {
        give_turn(number, kept);
    }
    return number;
}

void RequestPlan::Impl::give_turn(std::uint64_t number, Batch& batch)
{
    if (batch.has_turn) {
        return;
    }
    batch.has_turn = true;
    if (batch.result.is_write) {
        // The rest of a write goes before all later ones.
        writes.push_front(number);
    } else {
        reads.push_back(number);
    }
}

PlanRequest RequestPlan::Impl::send(std::uint64_t number, Batch& batch)
{
    PlanRequest request{++last_request, batch.result.is_write, batch.waiting.front().ranges};
    PlanJob job = std::move(batch.waiting.front());
    batch.waiting.pop_front();
    if (request.is_write) {
        const PlanPart& first = batch.parts[job.begin];
        const PlanRule* const rule = rules.find(first.address.area);
        const std::size_t count =
            std::size_t{request.ranges[0].width} * std::max(rule->words_per_unit, 1U);
        const auto begin = batch.to_write.begin() + static_cast<std::ptrdiff_t>(first.first_word);
        request.words.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
        request.mask = first.mask;
        is_writing = true;
    }
    ++counters.requests;
    counters.isolating += job.division == no_division ? 0 : 1;
    ++batch.under_way;
    sent.emplace(request.id, Sent{number, request.is_write, std::move(job)});
    return request;
}

std::optional<PlanRequest> RequestPlan::Impl::next_write()
{
    while (!writes.empty()) {
        const std::uint64_t number = writes.front();
        Batch& batch = batches.at(number);
        // The rest of a value whose first pieces failed.
        while (
            !batch.waiting.empty() && batch.parts[batch.waiting.front().begin].is_piece &&
            batch.result.values[batch.parts[batch.waiting.front().begin].index].status.is_bad()) {
            batch.waiting.pop_front();
        }
        std::optional<PlanRequest> request;
        if (!batch.waiting.empty()) {
            request = send(number, batch);
        }
        if (batch.waiting.empty()) {
            writes.pop_front();
            batch.has_turn = false;
            finish_if_done(number);
        }
        if (request) {
            return request;
        }
    }
    return std::nullopt;
}

std::optional<PlanRequest> RequestPlan::Impl::next_read()
{
    const std::uint64_t number = reads.front();
    reads.pop_front();
    Batch& batch = batches.at(number);
    PlanRequest request = send(number, batch);
    batch.has_turn = !batch.waiting.empty();
    if (batch.has_turn) {
        reads.push_back(number);
    }
    return request;
}

std::optional<Sent> RequestPlan::Impl::take_sent(std::uint64_t request)
{
    auto node = sent.extract(request);
    if (node.empty()) {
        ++counters.unexpected;
        return std::nullopt;
    }
    is_writing = is_writing && !node.mapped().is_write;
    const auto batch = batches.find(node.mapped().batch);
    if (batch == batches.end()) {
        return std::nullopt;
    }
    --batch->second.under_way;
    return std::move(node.mapped());
}

bool RequestPlan::Impl::take_words(Batch& batch, const PlanJob& job,
                                   std::span<const std::uint16_t> all)
{
    std::size_t expected = 0;
    for (const PlanAddress& range : job.ranges) {
        expected += std::size_t{range.width} * std::max(rules.find(range.area)->words_per_unit, 1U);
    }
    if (all.size() != expected) {
        return false;
    }
    std::size_t range = 0;
    for (std::size_t at = job.begin; at < job.end; ++at) {
        const PlanAddress& wanted = batch.parts[at].address;
        const auto is_in = [&](const PlanAddress& place) {
            return place.area == wanted.area && wanted.offset >= place.offset &&
                   std::uint64_t{wanted.offset} + wanted.width <=
                       std::uint64_t{place.offset} + place.width;
        };
        const std::size_t per_unit = std::max(rules.find(wanted.area)->words_per_unit, 1U);
        for (; !is_in(job.ranges[range]); ++range) {
            const PlanAddress& passed = job.ranges[range];
            all = all.subspan(passed.width *
                              std::size_t{std::max(rules.find(passed.area)->words_per_unit, 1U)});
        }
        const auto from = all.subspan((wanted.offset - job.ranges[range].offset) * per_unit,
                                      wanted.width * per_unit);
        std::copy(from.begin(), from.end(),
                  batch.result.words.begin() +
                      static_cast<std::ptrdiff_t>(batch.parts[at].first_word));
    }
    return true;
}

void RequestPlan::Impl::note_access(Batch& batch, const PlanJob& job, std::uint64_t request)
{
    for (std::size_t at = job.begin; at < job.end; ++at) {
        const PlanPart& part = batch.parts[at];
        if (!part.is_piece) {
            batch.result.values[part.index].access = request;
        }
        if (part.is_alone) {
            memory.accepted(part.address);
        }
    }
}

void RequestPlan::Impl::divide(Batch& batch, const Sent& refused, std::size_t middle, TimePoint now)
{
    std::vector<PlanJob> jobs;
    if (refused.is_write) {
        jobs = {detail::write_of(batch.parts, refused.job.begin, middle),
                detail::write_of(batch.parts, middle, refused.job.end)};
    } else {
        jobs = detail::lay_out(batch.parts, refused.job.begin, middle, rules, memory, now);
        auto second = detail::lay_out(batch.parts, middle, refused.job.end, rules, memory, now);
        std::move(second.begin(), second.end(), std::back_inserter(jobs));
    }
    const std::size_t division = batch.divisions.size();
    batch.divisions.push_back({batch.parts[middle].address, jobs.size()});
    batch.isolating_left -= std::min(batch.isolating_left, jobs.size());
    for (PlanJob& job : jobs) {
        job.division = division;
    }
    batch.waiting.insert(batch.waiting.begin(), std::make_move_iterator(jobs.begin()),
                         std::make_move_iterator(jobs.end()));
    give_turn(refused.batch, batch);
}

void RequestPlan::Impl::settle(Batch& batch, const Sent& answered, bool is_accepted, TimePoint now)
{
    if (answered.job.division == no_division) {
        return;
    }
    Division& division = batch.divisions[answered.job.division];
    division.is_accepted = division.is_accepted && is_accepted;
    --division.unanswered;
    if (division.unanswered == 0 && division.is_accepted && !answered.is_write) {
        memory.cut(division.second, now + config.cut_memory, now);
    }
}

void RequestPlan::Impl::finish_if_done(std::uint64_t number)
{
    const auto batch = batches.find(number);
    if (batch->second.waiting.empty() && batch->second.under_way == 0) {
        finish(batch);
    }
}

void RequestPlan::Impl::finish(std::map<std::uint64_t, Batch>::iterator batch)
{
    PlanResult& result = batch->second.result;
    for (PlanValue& value : result.values) {
        if (value.status.is_bad() && !result.is_write) {
            value.access = 0;
            std::fill_n(result.words.begin() + static_cast<std::ptrdiff_t>(value.first_word),
                        value.word_count, std::uint16_t{0});
        }
    }
    results.push_back(std::move(result));
    batches.erase(batch);
}

RequestPlan::RequestPlan(PlanConfig config) : impl_{std::make_unique<Impl>(std::move(config))} {}

RequestPlan::RequestPlan(RequestPlan&&) noexcept = default;
RequestPlan& RequestPlan::operator=(RequestPlan&&) noexcept = default;
RequestPlan::~RequestPlan() = default;

Result<std::uint64_t> RequestPlan::read(std::span<const PlanAddress> addresses, TimePoint now)
{
    if (!impl_->has_room(addresses.size())) {
        return busbar::fail(status::Bad_TooManyOperations);
    }
    Batch batch;
    batch.result.values.resize(addresses.size());
    std::size_t words = 0;
    for (std::size_t i = 0; i < addresses.size(); ++i) {
        const auto rule = impl_->admit(batch, addresses[i], i, words);
        if (!rule) {
            return busbar::fail(rule.error());
        }
        if (*rule != nullptr) {
            PlanPart part{.address = addresses[i], .sharing = (*rule)->sharing};
            part.index = static_cast<std::uint32_t>(i);
            part.first_word = batch.result.values[i].first_word;
            impl_->add_read(batch, part, **rule, now);
        }
    }
    batch.result.words.resize(words);
    detail::sort_parts(batch.parts);
    auto jobs =
        detail::lay_out(batch.parts, 0, batch.parts.size(), impl_->rules, impl_->memory, now);
    return impl_->begin(std::move(batch), std::move(jobs));
}

Result<std::uint64_t> RequestPlan::write(std::span<const PlanWrite> writes)
{
    if (!impl_->has_room(writes.size())) {
        return busbar::fail(status::Bad_TooManyOperations);
    }
    Batch batch;
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
    auto jobs = detail::lay_out_writes(batch.parts, impl_->rules);
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
    Batch& batch = impl_->batches.at(sent->batch);
    const bool is_complete = sent->is_write || impl_->take_words(batch, sent->job, words);
    if (is_complete) {
        impl_->note_access(batch, sent->job, request);
    } else {
        batch.set_status(sent->job, status::Bad_DecodingError);
    }
    impl_->settle(batch, *sent, is_complete, now);
    impl_->finish_if_done(sent->batch);
}

void RequestPlan::refuse(std::uint64_t request, StatusCode status, TimePoint now)
{
    const auto sent = impl_->take_sent(request);
    if (!sent) {
        return;
    }
    Batch& batch = impl_->batches.at(sent->batch);
    const PlanJob& job = sent->job;
    const std::size_t middle = detail::divide(batch.parts, job.begin, job.end);
    if (middle != job.end && batch.isolating_left >= 2) {
        impl_->divide(batch, *sent, middle, now);
    } else {
        batch.set_status(job, status);
        if (middle == job.end && !sent->is_write) {
            impl_->memory.refused(batch.parts[job.begin].address, never_good(status),
                                  now + impl_->config.refusal_memory, now);
        }
    }
    impl_->settle(batch, *sent, false, now);
    impl_->finish_if_done(sent->batch);
}

void RequestPlan::fail(std::uint64_t request, StatusCode status)
{
    const auto sent = impl_->take_sent(request);
    if (!sent) {
        return;
    }
    Batch& batch = impl_->batches.at(sent->batch);
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

void RequestPlan::forget_refusals()
{
    impl_->memory.forget();
}

} // namespace busbar::backend
