#pragma once

#include <optional>
#include <vector>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/view.hpp>

namespace busbar::client::detail {

/// The questions about a DataType: attributes, and references of three kinds.
inline constexpr std::size_t attributes_per_type = 3;
inline constexpr std::size_t browses_per_type = 3;

void ask_attributes(const NodeId& type, std::vector<ReadValueId>& items);
void ask_references(const NodeId& type, std::vector<BrowseDescription>& items);
/// The DataType of an encoding.
[[nodiscard]] BrowseDescription ask_type_of(const NodeId& encoding);
[[nodiscard]] std::optional<NodeId> type_of(const BrowseResult& answer);

[[nodiscard]] BrowseDescription references_of(const NodeId& node, std::uint32_t type,
                                              BrowseDirection direction);
/// Returns whether the node or attribute does not exist, as opposed to a missing answer.
[[nodiscard]] bool is_answer(StatusCode status);

/// The answers about a DataType.
struct TypeAnswers {
    binary::DataTypeEntry entry;
    /// EnumStrings or EnumValues, if there is no definition; else null.
    NodeId names;
    /// The server did not answer; another try later may help.
    bool has_failed{false};
};

/// `values` and `references` are the answers to the questions above, in their order.
[[nodiscard]] TypeAnswers read_answers(const NodeId& type, std::span<DataValue> values,
                                       std::span<const BrowseResult> references);
/// Returns the definition in EnumStrings, EnumValues or OptionSetValues (Part 3, 5.8.2 and 8.39).
[[nodiscard]] std::optional<EnumDefinition> definition_of(const Variant& names);

/// Returns the types that an entry needs, except those that are always known.
[[nodiscard]] std::vector<NodeId> needed_by(const binary::DataTypeEntry& entry);
/// True for types that need no description.
[[nodiscard]] bool is_known_to_all(const NodeId& type);

} // namespace busbar::client::detail
