#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/types/attribute.hpp>

#include "server/data/data_call.hpp"
#include "server/data/read_results.hpp"
#include "server/rights/read_plan.hpp"
#include "server/session/operand_text.hpp"
#include "server/session/turn.hpp"

namespace busbar::server::detail {

/// Returns Good, or why the whole request is refused (Part 4, 5.11.2.3).
[[nodiscard]] StatusCode check_read(const ReadRequest& request, std::size_t max_nodes);

/// The work of one Read (Part 4, 5.11.2) that passed check_read: the values of one source are
/// requested in one batch, everything else is answered from the address space. The number of
/// allocations does not depend on the number of scalars.
class ReadJob {
public:
    /// Approximate memory of an item until it is answered, including its place in the request.
    static constexpr std::size_t bytes_per_item =
        sizeof(ReadValueId) + sizeof(ReadItem) + sizeof(ReadSlot) + 64;

    /// `request` must not change until everything is planned. Answers take at most `max_response`
    /// bytes.
    ReadJob(DataSources& sources, const ReadRequest& request,
            std::size_t max_response = std::numeric_limits<std::size_t>::max());

    /// Looks up as many nodes as `turn` allows, at least one, and answers from the address space.
    /// False if there are more, for the next call. Keeps no reference to `context`.
    [[nodiscard]] bool plan(const ReadContext& context, Turn& turn);
    /// True if nodes that were looked up may have been removed or changed.
    [[nodiscard]] bool is_outdated(const model::AddressSpace& space) const
    {
        return planned_ != 0 && rebindings_ != space.journal().rebindings();
    }
    /// False if the answers from the address space alone exceed the response: the rest was not
    /// looked up, and nothing must be started.
    [[nodiscard]] bool fits() const { return writer_.ok(); }
    /// Bytes that it takes at the moment.
    [[nodiscard]] std::size_t held() const
    {
        return call_.size() * bytes_per_item + 2 * writer_.written() +
               encoded_.capacity() * sizeof(Encoded);
    }
    /// Returns true if the results are complete, else `owner` is notified.
    [[nodiscard]] bool start(SourceCallOwner& owner, TimePoint now);
    /// See SourceCall::service_result.
    [[nodiscard]] StatusCode service_result() const { return call_.service_result(); }
    [[nodiscard]] TimePoint next_deadline() const { return call_.next_deadline(); }
    /// Answers Bad_Timeout for late sources; true if nothing is pending any more.
    [[nodiscard]] bool handle_deadline(TimePoint now) { return call_.handle_deadline(now); }

    /// Cuts the ranges that were left to the server; called once, when the results are complete.
    void finish();
    /// Returns the diagnostics of each item, after finish().
    [[nodiscard]] Array<DiagnosticInfo> diagnose(ReturnDiagnostics& diagnostics) const;
    /// Writes `results` and `diagnostic_infos` of the ReadResponse; called once, after finish().
    /// `answered` is the time when the sources had answered.
    void encode_results(binary::Writer& writer, DateTime answered,
                        const Array<DiagnosticInfo>& infos = {});

private:
    /// An IndexRange of the request.
    struct Range {
        NumericRange range;
        std::size_t index;
        bool is_cut_here;
    };

    /// A DataValue that is already encoded.
    struct Encoded {
        std::uint32_t index;
        std::uint32_t size;
        StatusCode status;
    };

    void plan_one(const ReadContext& context, std::size_t index, model::NodeIndex node);
    /// Returns null if there is no range.
    [[nodiscard]] Result<NumericRange*> keep_range(std::size_t index, const String& text);

    void take_answer(std::size_t index, DataValue answer, const NumericRange* range);

    const ReadRequest& request_;
    std::size_t planned_{0};
    std::uint64_t rebindings_{0};
    SourceRead call_;
    Timestamps timestamps_;
    std::chrono::milliseconds max_age_;
    /// Answers of the address space, in the order of the request: one value may be requested many
    /// times, and its bytes are less than a copy.
    binary::VectorSink sink_;
    binary::Writer writer_;
    std::vector<Encoded> encoded_;
    /// Bytes of the last value before it was cut.
    std::size_t cut_{0};
    std::shared_ptr<std::vector<Range>> ranges_;
};

} // namespace busbar::server::detail
