#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/attribute.hpp>

#include "definition_checks.hpp"
#include "server/data/data_call.hpp"
#include "server/rights/node_rights.hpp"
#include "server/rights/registered_nodes.hpp"
#include "server/session/turn.hpp"

namespace busbar::server::detail {

/// What a Write looks at besides its request.
struct WriteContext {
    model::AddressSpace& space;
    DataSources& sources;
    NodeRights rights;
    DefinitionChecks& definitions;
    /// The source timestamp of kept values whose writer says none.
    DateTime now;
    /// Of texts that may be written, besides those that the address space has.
    std::span<const std::string> locales{};
    /// The aliases that NodeIds of the request may be; may be null.
    const RegisteredNodes* registered{nullptr};
};

/// Good, or why the whole request is refused (Part 4, 5.11.4.3).
[[nodiscard]] StatusCode check_write(const WriteRequest& request, std::size_t max_nodes);

/// The work of one Write (Part 4, 5.11.4) that passed check_write: the values for one source are
/// handed over in one batch, those that the address space keeps are replaced at once.
class WriteJob {
public:
    /// About what an item takes until it is answered, its place in the request included.
    static constexpr std::size_t bytes_per_item = sizeof(WriteValue) + sizeof(WriteItem) + 64;

    /// `request` must stay as it is until keep() or the end of the job.
    WriteJob(DataSources& sources, const WriteRequest& request);

    /// Checks as many values as `turn` allows, one at least, and replaces those that the address
    /// space keeps. False if there are more of them, for the next call. Keeps nothing of `context`.
    [[nodiscard]] bool plan(const WriteContext& context, Turn& turn);
    /// True if nodes that were looked up may not be there any more, or not be what they were.
    [[nodiscard]] bool is_outdated(const model::AddressSpace& space) const
    {
        return planned_ != 0 && rebindings_ != space.journal().rebindings();
    }
    /// True if the results are there, else `owner` is told.
    [[nodiscard]] bool start(SourceCallOwner& owner, TimePoint now);
    /// See SourceCall::service_result.
    [[nodiscard]] StatusCode service_result() const { return call_.service_result(); }
    [[nodiscard]] TimePoint next_deadline() const { return call_.next_deadline(); }
    /// Answers Bad_Timeout for sources that are late; true if nothing is waited for any more.
    [[nodiscard]] bool handle_deadline(TimePoint now) { return call_.handle_deadline(now); }
    /// What became of an item, once the results are there.
    [[nodiscard]] StatusCode result(std::size_t index) const { return call_.result(index); }
    /// Why its source refused it; empty if that is not known.
    [[nodiscard]] std::string_view reason(std::size_t index) const
    {
        const WritePart* const part = call_.part_of(index);
        return part != nullptr ? std::string_view{part->reason} : std::string_view{};
    }
    /// The nodes of the items that were looked at, no_node where there was none.
    [[nodiscard]] std::span<const model::NodeHandle> nodes() const { return nodes_; }
    /// Writes `results` and `diagnostic_infos` of the WriteResponse.
    void encode_results(binary::Writer& writer, const Array<DiagnosticInfo>& infos = {}) const;

    /// Takes over the request and the message that it borrows from: sources may still have batches
    /// with the values when client and server have given up. The last of them frees both.
    void keep(WriteRequest request, std::vector<std::byte> message);

private:
    /// What sources were given the addresses of.
    struct Memory {
        std::vector<NumericRange> ranges;
        std::vector<std::unique_ptr<const DataValue>> converted;
        std::vector<std::byte> message;
        WriteRequest request;
    };
    struct Target {
        model::NodeIndex node;
        model::VariableAttributes variable;
    };

    [[nodiscard]] std::optional<StatusCode> plan_one(const WriteContext& context, std::size_t index,
                                                     model::NodeIndex node);
    [[nodiscard]] std::optional<StatusCode> plan_value(const WriteContext& context,
                                                       std::size_t index, const WriteValue& value,
                                                       const Target& target);
    /// Null if there is no range.
    [[nodiscard]] Result<const NumericRange*> keep_range(std::size_t index, const String& text);
    [[nodiscard]] const DataValue* to_byte_array(const DataValue& data);

    const WriteRequest& request_;
    std::size_t planned_{0};
    std::vector<model::NodeHandle> nodes_;
    /// Bytes of the last kept value that a range was of.
    std::size_t copied_{0};
    std::uint64_t rebindings_{0};
    SourceWrite call_;
    std::shared_ptr<Memory> memory_;
};

} // namespace busbar::server::detail
