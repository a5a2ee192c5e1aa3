#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <busbar/backend/plan.hpp>
#include <busbar/core/status_codes.hpp>

#include "backend/plan/layout.hpp"
#include "backend/plan/memory.hpp"

namespace busbar::backend {

namespace detail {

[[nodiscard]] inline StatusCode never_good(StatusCode status)
{
    return status.is_good() ? StatusCode{status::Bad_UnexpectedError} : status;
}

/// A refused request that was planned again in parts.
struct PlanDivision {
    /// The first address of the second half.
    PlanAddress second{};
    std::size_t unanswered{0};
    bool is_accepted{true};
};

struct PlanBatch {
    PlanResult result{};
    /// Sorted for a read, in the order of the addresses for a write.
    std::vector<PlanPart> parts{};
    /// The words of a write, in the order of the addresses.
    std::vector<std::uint16_t> to_write{};
    std::deque<PlanJob> waiting{};
    std::vector<PlanDivision> divisions{};
    std::size_t under_way{0};
    /// Requests that may still be added to find refused addresses.
    std::size_t isolating_left{0};
    /// It is in the list of those that have something to send.
    bool has_turn{false};

    void set_status(const PlanJob& job, StatusCode status, std::uint16_t code = 0)
    {
        for (std::size_t at = job.begin; at < job.end; ++at) {
            PlanValue& value = result.values[parts[at].index];
            if (value.status.is_good()) {
                value.status = never_good(status);
                value.code = code;
            }
        }
    }
};

/// A request that is under way.
struct PlanSent {
    std::uint64_t batch{0};
    bool is_write{false};
    PlanJob job{};
    /// PlanRules::version() at that time.
    std::uint64_t rules{0};
};

[[nodiscard]] inline std::size_t words_of(const PlanResult& result)
{
    std::size_t words = 0;
    for (const PlanValue& value : result.values) {
        words += value.word_count;
    }
    return words;
}

} // namespace detail

struct RequestPlan::Impl {
    explicit Impl(PlanConfig given)
        : config{std::move(given)}, rules{std::move(config.rules)}, memory{config.max_remembered}
    {
    }

    /// Makes place for an address and returns its rule; null if no request can have it.
    [[nodiscard]] Result<const PlanRule*> admit(detail::PlanBatch& batch,
                                                const PlanAddress& address, std::size_t index,
                                                std::size_t& words) const;
    void add_read(detail::PlanBatch& batch, detail::PlanPart part, const PlanRule& rule,
                  TimePoint now);
    [[nodiscard]] bool has_room(std::size_t more_addresses) const;
    [[nodiscard]] std::uint64_t begin(detail::PlanBatch batch, std::vector<detail::PlanJob> jobs);

    [[nodiscard]] std::optional<PlanRequest> next_write();
    [[nodiscard]] std::optional<PlanRequest> next_read();
    [[nodiscard]] PlanRequest send(std::uint64_t number, detail::PlanBatch& batch);

    /// Ends a request. None if it is not under way, or its batch was cancelled.
    [[nodiscard]] std::optional<detail::PlanSent> take_sent(std::uint64_t request);
    /// Takes the words of a read; false if they are not as many as its ranges have.
    [[nodiscard]] bool take_words(detail::PlanBatch& batch, const detail::PlanJob& job,
                                  std::span<const std::uint16_t> words);
    void note_access(detail::PlanBatch& batch, const detail::PlanJob& job, std::uint64_t request);
    void divide(detail::PlanBatch& batch, const detail::PlanSent& sent, std::size_t middle,
                TimePoint now);
    /// Returns requests for these parts by the present rules.
    [[nodiscard]] std::vector<detail::PlanJob> lay_out(const detail::PlanBatch& batch,
                                                       std::size_t begin, std::size_t end,
                                                       TimePoint now) const;
    /// Plans a job of several ranges again; the same as before if it has one.
    [[nodiscard]] std::vector<detail::PlanJob>
    lay_out_again(detail::PlanBatch& batch, detail::PlanJob job, TimePoint now) const;
    /// A request of a division has its answer.
    void settle(detail::PlanBatch& batch, const detail::PlanSent& sent, bool is_accepted,
                TimePoint now);

    void give_turn(std::uint64_t number, detail::PlanBatch& batch);
    void finish_if_done(std::uint64_t number);
    void finish(std::map<std::uint64_t, detail::PlanBatch>::iterator batch);

    PlanConfig config;
    detail::PlanRules rules;
    detail::PlanMemory memory;
    std::map<std::uint64_t, detail::PlanBatch> batches{};
    /// Batches that have reads to send, by turns, and writes, in their order.
    std::deque<std::uint64_t> reads{};
    std::deque<std::uint64_t> writes{};
    std::map<std::uint64_t, detail::PlanSent> sent{};
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

} // namespace busbar::backend
