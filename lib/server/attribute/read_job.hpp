#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/types/attribute.hpp>

#include "server/data/data_call.hpp"
#include "server/data/read_results.hpp"
#include "server/rights/read_plan.hpp"

namespace busbar::server::detail {

/// Good, or why the whole request is refused (Part 4, 5.11.2.3).
[[nodiscard]] StatusCode check_read(const ReadRequest& request, std::size_t max_nodes);

/// The work of one Read (Part 4, 5.11.2) that passed check_read: the values of one source are asked
/// for in one batch, everything else is answered from the address space. The number of allocations
/// does not depend on how many scalars are read.
class ReadJob {
public:
    /// About what an item takes until it is answered, its place in the request included.
    static constexpr std::size_t bytes_per_item =
        sizeof(ReadValueId) + sizeof(ReadItem) + sizeof(ReadSlot) + 64;

    /// Keeps no reference to `request`, and of `context` only the sources.
    ReadJob(const ReadContext& context, const ReadRequest& request);

    /// False if what was found in the address space alone is more than the response may have: the
    /// rest was not looked at, and nothing is to be started.
    [[nodiscard]] bool fits() const { return room_ != 0; }
    /// True if the results are there, else `owner` is told.
    [[nodiscard]] bool start(SourceCallOwner& owner, TimePoint now);
    [[nodiscard]] TimePoint next_deadline() const { return call_.next_deadline(); }
    /// Answers Bad_Timeout for sources that are late; true if nothing is waited for any more.
    [[nodiscard]] bool handle_deadline(TimePoint now) { return call_.handle_deadline(now); }

    /// Cuts the ranges that were left to the server; once, when the results are there.
    void finish();
    /// Writes `results` and `diagnostic_infos` of the ReadResponse; after finish().
    void encode_results(binary::Writer& writer) const;

private:
    /// An IndexRange of the request.
    struct Range {
        NumericRange range;
        std::size_t index;
        bool is_cut_here;
    };

    void plan(const ReadContext& context, std::size_t index, const ReadValueId& id);
    /// Null if there is no range.
    [[nodiscard]] Result<NumericRange*> keep_range(std::size_t index, const String& text);

    void take_answer(std::size_t index, DataValue answer, const NumericRange* range);

    SourceRead call_;
    /// Bytes that the response has left for answers; none once it cannot fit.
    std::size_t room_;
    Timestamps timestamps_;
    std::chrono::milliseconds max_age_;
    std::shared_ptr<std::vector<Range>> ranges_;
};

} // namespace busbar::server::detail
