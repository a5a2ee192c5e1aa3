#include "backend/plan/state.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace busbar::backend {

namespace {

using detail::no_division;
using detail::PlanBatch;
using detail::PlanJob;
using detail::PlanPart;
using detail::PlanSent;
using detail::words_of;

} // namespace

Result<const PlanRule*> RequestPlan::Impl::admit(PlanBatch& batch, const PlanAddress& address,
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

void RequestPlan::Impl::add_read(PlanBatch& batch, PlanPart part, const PlanRule& rule,
                                 TimePoint now)
{
    const std::size_t first = batch.parts.size();
    detail::append_pieces(batch.parts, part, rule.max_read, std::max(rule.words_per_unit, 1U));
    for (std::size_t at = first; at < batch.parts.size(); ++at) {
        const auto* const refusal = memory.refusal_of(batch.parts[at].address);
        if (refusal == nullptr) {
            continue;
        }
        batch.parts[at].is_alone = true;
        if (now < refusal->until) {
            batch.result.values[part.index].status = refusal->status;
            batch.result.values[part.index].code = refusal->code;
            batch.parts.resize(first);
            ++counters.remembered;
        }
    }
}

std::uint64_t RequestPlan::Impl::begin(PlanBatch batch, std::vector<PlanJob> jobs)
{
    const std::uint64_t number = ++last_batch;
    batch.result.batch = number;
    batch.isolating_left = config.max_isolating;
    batch.waiting.assign(std::make_move_iterator(jobs.begin()),
                         std::make_move_iterator(jobs.end()));
    addresses += batch.result.values.size();
    counters.addresses += batch.result.values.size();
    words += words_of(batch.result);
    PlanBatch& kept = batches.emplace(number, std::move(batch)).first->second;
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

void RequestPlan::Impl::give_turn(std::uint64_t number, PlanBatch& batch)
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

PlanRequest RequestPlan::Impl::send(std::uint64_t number, PlanBatch& batch)
{
    PlanRequest request{++last_request, batch.result.is_write, batch.waiting.front().ranges};
    PlanJob job = std::move(batch.waiting.front());
    batch.waiting.pop_front();
    if (request.is_write) {
        const PlanPart& first = batch.parts[job.begin];
        std::size_t count = 0;
        for (const PlanAddress& range : request.ranges) {
            count +=
                std::size_t{range.width} * std::max(rules.find(range.area)->words_per_unit, 1U);
        }
        const auto begin = batch.to_write.begin() + static_cast<std::ptrdiff_t>(first.first_word);
        request.words.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
        request.mask = first.mask;
        is_writing = true;
    }
    ++counters.requests;
    counters.isolating += job.division == no_division ? 0 : 1;
    ++batch.under_way;
    sent.emplace(request.id, PlanSent{number, request.is_write, std::move(job), rules.version()});
    return request;
}

std::optional<PlanRequest> RequestPlan::Impl::next_write()
{
    while (!writes.empty()) {
        const std::uint64_t number = writes.front();
        PlanBatch& batch = batches.at(number);
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
    PlanBatch& batch = batches.at(number);
    PlanRequest request = send(number, batch);
    batch.has_turn = !batch.waiting.empty();
    if (batch.has_turn) {
        reads.push_back(number);
    }
    return request;
}

std::optional<PlanSent> RequestPlan::Impl::take_sent(std::uint64_t request)
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

bool RequestPlan::Impl::take_words(PlanBatch& batch, const PlanJob& job,
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

void RequestPlan::Impl::note_access(PlanBatch& batch, const PlanJob& job, std::uint64_t request)
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

std::vector<PlanJob> RequestPlan::Impl::lay_out(const PlanBatch& batch, std::size_t begin,
                                                std::size_t end, TimePoint now) const
{
    return batch.result.is_write ? detail::lay_out_writes(batch.parts, begin, end, rules)
                                 : detail::lay_out(batch.parts, begin, end, rules, memory, now);
}

std::vector<PlanJob> RequestPlan::Impl::lay_out_again(PlanBatch& batch, PlanJob job,
                                                      TimePoint now) const
{
    if (job.ranges.size() == 1) {
        return {std::move(job)};
    }
    auto jobs = lay_out(batch, job.begin, job.end, now);
    for (PlanJob& each : jobs) {
        each.division = job.division;
    }
    if (job.division != no_division) {
        batch.divisions[job.division].unanswered += jobs.size() - 1;
    }
    return jobs;
}

void RequestPlan::Impl::divide(PlanBatch& batch, const PlanSent& refused, std::size_t middle,
                               TimePoint now)
{
    std::vector<PlanJob> jobs = lay_out(batch, refused.job.begin, middle, now);
    auto second = lay_out(batch, middle, refused.job.end, now);
    std::move(second.begin(), second.end(), std::back_inserter(jobs));
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

void RequestPlan::Impl::settle(PlanBatch& batch, const PlanSent& answered, bool is_accepted,
                               TimePoint now)
{
    if (answered.job.division == no_division) {
        return;
    }
    detail::PlanDivision& division = batch.divisions[answered.job.division];
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

void RequestPlan::Impl::finish(std::map<std::uint64_t, PlanBatch>::iterator batch)
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
} // namespace busbar::backend
