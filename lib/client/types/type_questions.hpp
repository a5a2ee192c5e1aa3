#pragma once

#include <optional>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/view.hpp>

namespace busbar::client::detail {

/// What the server is asked about a DataType: attributes, and references of three kinds.
inline constexpr std::size_t attributes_per_type = 3;
inline constexpr std::size_t browses_per_type = 3;

void ask_attributes(const NodeId& type, std::vector<ReadValueId>& items);
void ask_references(const NodeId& type, std::vector<BrowseDescription>& items);
/// The DataType of an encoding.
[[nodiscard]] BrowseDescription ask_type_of(const NodeId& encoding);
[[nodiscard]] std::optional<NodeId> type_of(const BrowseResult& answer);

[[nodiscard]] BrowseDescription references_of(const NodeId& node, std::uint32_t type,
                                              BrowseDirection direction);
/// That the node or attribute is not there, rather than that nobody answered.
[[nodiscard]] bool is_answer(StatusCode status);

/// What a DataType's answers say.
struct TypeAnswers {
    binary::DataTypeEntry entry;
    /// EnumStrings or EnumValues, where there is no definition; else null.
    NodeId names;
    /// The server did not answer; it is worth another try later.
    bool has_failed{false};
};

/// `values` and `references` are the answers to the questions above, in their order.
[[nodiscard]] TypeAnswers read_answers(const NodeId& type, std::span<DataValue> values,
                                       std::span<const BrowseResult> references);
/// What EnumStrings, EnumValues or OptionSetValues say (Part 3, 5.8.2 and 8.39).
[[nodiscard]] std::optional<EnumDefinition> definition_of(const Variant& names);

/// The types that an entry needs, but for those that everybody knows.
[[nodiscard]] std::vector<NodeId> needed_by(const binary::DataTypeEntry& entry);
/// True for types that need no description.
[[nodiscard]] bool is_known_to_all(const NodeId& type);

} // namespace busbar::client::detail
