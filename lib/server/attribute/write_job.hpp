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
#include <busbar/core/attribute_id.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/attribute.hpp>

#include "definition_checks.hpp"
#include "server/data/data_call.hpp"
#include "server/rights/node_rights.hpp"
#include "server/rights/registered_nodes.hpp"
#include "server/session/turn.hpp"

namespace busbar::server::detail {

/// The context of a Write in addition to its request.
struct WriteContext {
    model::AddressSpace& space;
    DataSources& sources;
    NodeRights rights;
    DefinitionChecks& definitions;
    /// The source timestamp of kept values if the client sends none.
    DateTime now;
    /// Locales of texts that may be written, in addition to those in the address space.
    std::span<const std::string> locales{};
    /// The aliases that may be among the NodeIds of the request; may be null.
    const RegisteredNodes* registered{nullptr};
};

/// Returns Good, or why the whole request is refused (Part 4, 5.11.4.3).
[[nodiscard]] StatusCode check_write(const WriteRequest& request, std::size_t max_nodes);

/// The work of one Write (Part 4, 5.11.4) that passed check_write: the values for one source are
/// passed in one batch, those in the address space are replaced at once.
class WriteJob {
public:
    /// Approximate memory of an item until it is answered, including its place in the request.
    static constexpr std::size_t bytes_per_item = sizeof(WriteValue) + sizeof(WriteItem) + 64;

    /// `request` must not change until keep() or the end of the job.
    WriteJob(DataSources& sources, const WriteRequest& request);

    /// Checks as many values as `turn` allows, at least one, and replaces those in the address
    /// space. False if there are more, for the next call. Keeps no reference to `context`.
    [[nodiscard]] bool plan(const WriteContext& context, Turn& turn);
    /// True if nodes that were looked up may have been removed or changed.
    [[nodiscard]] bool is_outdated(const model::AddressSpace& space) const
    {
        return planned_ != 0 && rebindings_ != space.journal().rebindings();
    }
    /// Plans again which sources get which values, since what was looked up is outdated. Values in
    /// the address space were replaced and stay as they are.
    void plan_again();
    /// Returns true if the results are complete, else `owner` is notified.
    [[nodiscard]] bool start(SourceCallOwner& owner, TimePoint now);
    /// See SourceCall::service_result.
    [[nodiscard]] StatusCode service_result() const { return call_.service_result(); }
    [[nodiscard]] TimePoint next_deadline() const { return call_.next_deadline(); }
    /// Answers Bad_Timeout for late sources; true if nothing is pending any more.
    [[nodiscard]] bool handle_deadline(TimePoint now) { return call_.handle_deadline(now); }
    /// The result of an item, once the results are complete.
    [[nodiscard]] StatusCode result(std::size_t index) const { return call_.result(index); }
    /// The result of an item at any time, `otherwise` if it has none yet.
    [[nodiscard]] StatusCode result_or(std::size_t index, StatusCode otherwise) const
    {
        const StatusCode* const result = call_.find_result(index);
        return result != nullptr ? *result : otherwise;
    }
    /// The reason why its source refused it; empty if unknown.
    [[nodiscard]] std::string_view reason(std::size_t index) const
    {
        const WritePart* const part = call_.part_of(index);
        return part != nullptr ? std::string_view{part->reason} : std::string_view{};
    }
    /// The nodes of the items, no_node if there was none, or it is not planned yet.
    [[nodiscard]] std::span<const model::NodeHandle> nodes() const { return nodes_; }
    /// Writes `results` and `diagnostic_infos` of the WriteResponse.
    void encode_results(binary::Writer& writer, const Array<DiagnosticInfo>& infos = {}) const;

    /// Takes over the request and the message that it borrows from: sources may still have batches
    /// with the values when client and server have given up. The last one frees both.
    void keep(WriteRequest request, std::vector<std::byte> message);

private:
    /// Memory whose addresses the sources have.
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
    /// Returns null if there is no range.
    [[nodiscard]] Result<const NumericRange*> keep_range(std::size_t index, const String& text);
    [[nodiscard]] const DataValue* to_byte_array(const DataValue& data);

    const WriteRequest& request_;
    std::size_t planned_{0};
    std::vector<model::NodeHandle> nodes_;
    /// Bytes of the last kept value that a range was part of.
    std::size_t copied_{0};
    std::uint64_t rebindings_{0};
    SourceWrite call_;
    std::shared_ptr<Memory> memory_;
};

/// Each use of the node searches all of them.
inline constexpr std::size_t max_written_role_permissions = 100;

/// Writes any attribute except the Value of a Variable (Part 4, 5.11.4), of nodes that the user may
/// see: an attribute that UserWriteMask allows is replaced at once.
///
/// Bad_SecurityModeInsufficient, Bad_AttributeIdInvalid if it does not exist, Bad_NotWritable if it
/// is not in the WriteMask, Bad_WriteNotSupported if it is in NodeAccess but the server cannot
/// write it, or for an IndexRange, a status or a timestamp, Bad_UserAccessDenied; then
/// Bad_TypeMismatch, Bad_OutOfRange or Bad_LocaleNotSupported for the value.
[[nodiscard]] StatusCode write_attribute(const WriteContext& context, model::NodeIndex node,
                                         const WriteValue& value);

/// Part 4, 5.11.4.1: a text has no locale, one of the server's, or that of an existing text.
[[nodiscard]] StatusCode check_locale(const WriteContext& context, model::NodeIndex node,
                                      AttributeId attribute, const LocalizedText& text);

} // namespace busbar::server::detail
