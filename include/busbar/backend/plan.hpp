#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/core/result.hpp>

/// The plan that turns batches of addresses into few requests to a PLC; the same for each protocol
/// that has areas of numbered words or bits.
namespace busbar::backend {

/// A place in a PLC's memory: units of one area, which follow one another. A unit is what the
/// protocol counts there: a register, a word, a bit, a timer.
struct PlanAddress {
    /// The protocol's own number for the area; it must have a PlanRule.
    std::uint32_t area{0};
    /// Number of the first unit.
    std::uint32_t offset{0};
    /// Number of units, at least 1.
    std::uint32_t width{1};

    // NOLINTNEXTLINE(modernize-use-nullptr): the compiler's own comparison has a 0
    friend auto operator<=>(const PlanAddress&, const PlanAddress&) = default;
};

/// What one request may have of several ranges, if the protocol has such requests. A word is one of
/// PlanRule::words_per_unit, or PlanShare::units_per_word bits that have a place in one.
struct PlanShare {
    /// Ranges of areas whose rules have the same number here go together. These rules must have the
    /// same limits here.
    std::uint32_t group{0};
    /// Ranges that a request may have, each as a place and a length; 1 if there is no such request.
    std::uint32_t max_ranges{1};
    /// Words of all of these, with `range_cost` for each range.
    std::uint32_t max_words{0};
    /// Words that a range costs in addition to its own.
    std::uint32_t range_cost{0};
    /// Words of a request that names each of them by itself, whatever ranges they are of; 0 if
    /// there is no such request.
    std::uint32_t max_listed{0};
    /// Units in one word: 16 for bits that such a request has as the words that they are in.
    std::uint32_t units_per_word{1};

    friend bool operator==(const PlanShare&, const PlanShare&) = default;
};

/// The limits of requests for an area.
struct PlanRule {
    /// The area that it is about.
    std::uint32_t area{0};
    /// Units of one range that a request may read; at least 1.
    std::uint32_t max_read{1};
    /// Units of one range that a request may write; at least 1.
    std::uint32_t max_write{1};
    /// Units between two addresses that are read in vain, since that costs less than a request.
    std::uint32_t max_gap{0};
    /// Words that the PLC sends for one unit. A bit is one word here, 0 or 1.
    std::uint32_t words_per_unit{1};
    /// Several ranges in one read.
    PlanShare read{};
    /// Several ranges in one write.
    PlanShare write{};

    friend bool operator==(const PlanRule&, const PlanRule&) = default;
};

/// The configuration of a RequestPlan. Every limit is finite.
struct PlanConfig {
    /// One for each area, in any order; the first one counts.
    std::vector<PlanRule> rules{};
    /// Requests that the peer takes at a time.
    std::size_t max_under_way{1};
    /// Batches that wait or are under way; beyond: Bad_TooManyOperations.
    std::size_t max_batches{256};
    /// Addresses of these batches, likewise.
    std::size_t max_addresses{1'000'000};
    /// Words of these batches, likewise.
    std::size_t max_words{4'000'000};
    /// Requests in addition to the planned ones that a batch may have to find the addresses that
    /// the peer refuses. After them, all addresses of a refused request have its status.
    std::size_t max_isolating{256};
    /// A refused address has the same answer, without a request, for this long.
    Duration refusal_memory{std::chrono::seconds{10}};
    /// Two ranges that the peer takes only apart are kept apart for this long.
    Duration cut_memory{std::chrono::minutes{10}};
    /// Addresses, and pairs of ranges, that are remembered so.
    std::size_t max_remembered{4096};
};

/// A request to be sent.
struct PlanRequest {
    /// Never 0, and different from those of all other requests of the plan.
    std::uint64_t id{0};
    /// Whether it writes or reads.
    bool is_write{false};
    /// One, or several within the limits of a PlanShare: for a read in the order of area and
    /// offset, for a write in the order of the writes, without one that overlaps another.
    std::vector<PlanAddress> ranges{};
    /// Write: the words of all ranges, as many as their units have.
    std::vector<std::uint16_t> words{};
    /// Write: the bits of the word that are written; others must keep their values.
    std::uint16_t mask{0xFFFF};
};

/// One value to write.
struct PlanWrite {
    /// The place that is written.
    PlanAddress address;
    /// `width` times PlanRule::words_per_unit; copied.
    std::span<const std::uint16_t> words;
    /// With another value than FFFF, which only an address of one word may have, bits that are 0
    /// here keep their values. Such a write is a request of its own.
    std::uint16_t mask{0xFFFF};
};

/// The answer for one address of a batch.
struct PlanValue {
    /// Bad_ConfigurationError for an address that no request can have: an area without a rule, no
    /// width, an end past 2^32, words that do not fit. Otherwise the peer's answer.
    StatusCode status;
    /// The request that it was read or written with: values with the same number are of one access.
    /// 0 if there was none, or if it took several requests and may be torn.
    std::uint64_t access{0};
    /// Read: the place of its words in PlanResult::words; they are zeros unless the status is Good.
    std::size_t first_word{0};
    /// Read: how many words it has, 0 with Bad_ConfigurationError.
    std::size_t word_count{0};
    /// The protocol's own code of a refusal, as refuse() was given it; 0 without one.
    std::uint16_t code{0};
};

/// A finished batch.
struct PlanResult {
    /// The number that read() or write() returned.
    std::uint64_t batch{0};
    /// Whether it was written or read.
    bool is_write{false};
    /// One for each address, in the order of the batch.
    std::vector<PlanValue> values;
    /// Read: the words of all values.
    std::vector<std::uint16_t> words;

    /// The words of one of `values`.
    [[nodiscard]] std::span<const std::uint16_t> words_of(const PlanValue& value) const
    {
        return std::span{words}.subspan(value.first_word, value.word_count);
    }
};

/// Counts the work of a plan since its construction.
struct PlanCounters {
    /// Addresses of all batches.
    std::uint64_t addresses{0};
    /// Requests that next_request() returned.
    std::uint64_t requests{0};
    /// Requests that were sent to find refused addresses, which are among `requests`.
    std::uint64_t isolating{0};
    /// Addresses that were answered from memory.
    std::uint64_t remembered{0};
    /// Answers that no request waited for.
    std::uint64_t unexpected{0};
};

/// Turns the reads and writes of one PLC into the fewest requests within the limits of its
/// protocol, and the answers into values. It knows neither protocol nor connection, in the shape of
/// an engine: batches and answers go in, requests and results come out. For one thread.
///
/// Reads. Addresses of a batch are sorted; equal, overlapping and adjacent ones, and those with a
/// gap of at most max_gap between them, share a range. An address that is wider than max_read is
/// read in pieces. Batches take turns, a request each, so that a long one delays no other.
///
/// Refusals. A request that the peer refuses is divided in two, until the addresses that it refuses
/// are found; all others have their values. A refused address is not part of other requests any
/// more and is tried by itself when refusal_memory is over. If the peer takes both halves, what
/// lies between them is not read any more while cut_memory lasts. A peer that does not have
/// requests of several ranges is told apart from this: change_rules(), and plan_again() for the
/// request.
///
/// Writes. Each is sent once, in the order given, one request at a time and before waiting
/// reads, of which one may go after eight writes in a row. Neighbours of one batch share a request
/// if they follow one another in address, too, or if the protocol has requests of several ranges,
/// and none overlaps another; if that is refused, its halves are sent, the first one first.
class BUSBAR_API RequestPlan {
public:
    explicit RequestPlan(PlanConfig config);
    RequestPlan(RequestPlan&&) noexcept;
    RequestPlan& operator=(RequestPlan&&) noexcept;
    ~RequestPlan();

    /// Begins a batch and returns its number, which its result will have. Bad_TooManyOperations if
    /// the limits of the configuration are reached. A batch without addresses is finished at once.
    [[nodiscard]] Result<std::uint64_t> read(std::span<const PlanAddress> addresses, TimePoint now);
    /// Likewise for writes.
    [[nodiscard]] Result<std::uint64_t> write(std::span<const PlanWrite> writes);
    /// Forgets a batch: it has no result, and answers to its requests are dropped; until they come,
    /// or fail, its requests count as under way. Writes that were not sent are never sent.
    void cancel(std::uint64_t batch);

    /// Returns the next request to send; none if max_under_way are, or nothing waits. Each must be
    /// brought to an end by one of the next functions up to fail_all().
    [[nodiscard]] std::optional<PlanRequest> next_request();
    /// The peer has done the request. A read needs the words of all ranges, one after the other;
    /// with another number its addresses have Bad_DecodingError.
    void answer(std::uint64_t request, std::span<const std::uint16_t> words, TimePoint now);
    /// The peer refuses what the request has in it: an address, a length, a value. `code` is its
    /// own code for that.
    void refuse(std::uint64_t request, StatusCode status, TimePoint now, std::uint16_t code = 0);
    /// The peer does not have requests of this kind, and nothing was read or written. The addresses
    /// are asked for again by the rules of the last change_rules(), as the same request, too; they
    /// are refused with Bad_NotSupported if the rules are those that it was planned by.
    void plan_again(std::uint64_t request, TimePoint now);
    /// The request has no answer, such as Bad_Timeout, or failed for a reason that is not in it,
    /// such as a lock. All its addresses have this status.
    void fail(std::uint64_t request, StatusCode status);
    /// The connection is lost: every batch is finished, with this status for what has no answer
    /// yet. Nothing is under way any more.
    void fail_all(StatusCode status);

    /// Returns the next finished batch.
    [[nodiscard]] std::optional<PlanResult> next_result();

    /// Requests that have been sent and not brought to an end.
    [[nodiscard]] std::size_t under_way() const;
    /// True if next_request() has something that only max_under_way may hold back.
    [[nodiscard]] bool has_waiting() const;
    /// The work so far.
    [[nodiscard]] const PlanCounters& counters() const;
    /// Changes the rules of areas, since more is known of the peer, and the number of requests that
    /// it takes at a time. What waits with several ranges is planned again. An area keeps its
    /// words_per_unit; max_read and max_write become smaller only while no batch waits.
    void change_rules(std::span<const PlanRule> rules, std::size_t max_under_way, TimePoint now);
    /// Forgets which addresses were refused, such as after a reconnection or another program.
    void forget_refusals();

private:
    struct Impl;

    std::unique_ptr<Impl> impl_;
};

} // namespace busbar::backend
