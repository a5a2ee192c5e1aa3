#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/model/nodeset_types.hpp>

/// Reads and writes NodeSet2 files (Part 6, Annex F) at run time. It is in the target
/// busbar::nodeset, which needs pugixml; a server with constant nodes only links busbar::model
/// without it.
namespace busbar::model {

/// One file, or a text in memory with a name for messages.
struct NodeSetSource {
    /// The path, or a name for messages if there is a text.
    std::string name;
    std::optional<std::string> text{};
    /// Repairs defects that files of vendors have (NodeSetRule) instead of refusing the file.
    bool is_lenient{false};
};

/// The result of loading.
struct NodeSetSummary {
    std::size_t node_count{0};
    /// Number of nodes of namespace 0 that the files have and the AddressSpace had already.
    std::size_t skipped_count{0};
    /// Indices of the namespaces that received nodes.
    std::vector<std::uint16_t> namespaces;
    /// Defects that are not errors: references that are not hierarchical and lead nowhere, which
    /// were left out, and fields of a DataType that is nowhere. At most NodeSetLimits::max_errors.
    std::vector<Problem> notes;
    /// Changes to lenient sources, at most NodeSetLimits::max_errors.
    std::vector<NodeSetRepair> repairs;
    /// The number of all changes, by NodeSetRule.
    std::array<std::size_t, nodeset_rule_count> repair_counts{};
    /// The extras that write_nodeset needs in addition to the AddressSpace.
    NodeSetExtras extras;
};

/// Adds the nodes of NodeSet2 files to `space`. The files may be given in any order and may refer
/// to one another; one file may have several namespaces, which are added as needed.
///
/// Every type, target of a hierarchical reference, type definition and DataType must be in the
/// files or in `space`; so must every RequiredModel, in the required version or a later one (Part
/// 6, F.5). Every value must fit its Variable; a list with as many elements as ArrayDimensions say
/// becomes a matrix. XML with a DOCTYPE is refused. Models that exceed the default `limits` need
/// limits_for_large_models().
///
/// If it returns problems, at least one, `space` is as it was before. `where` of each has the file,
/// the line and the node as the file writes it, as far as they are known: "tags.xml:17: ns=1;i=5".
[[nodiscard]] BUSBAR_API Expected<NodeSetSummary, std::vector<Problem>>
load_nodesets(AddressSpace& space, std::span<const NodeSetSource> sources,
              const NodeSetLimits& limits = {});

/// The name of a rule in messages, such as "dangling-reference".
[[nodiscard]] BUSBAR_API std::string_view name(NodeSetRule rule);
/// Returns the effect of a rule: "references that lead nowhere were left out".
[[nodiscard]] BUSBAR_API std::string_view effect(NodeSetRule rule);
/// "a.xml:17: ns=1;i=5: left out ... (rule dangling-reference)"
[[nodiscard]] BUSBAR_API std::string text(const NodeSetRepair& repair);
/// One line for each rule that was applied: "3 times dangling-reference: references that ...".
[[nodiscard]] BUSBAR_API std::vector<std::string> counted_repairs(const NodeSetSummary& summary);

/// Writes the nodes of these namespaces as one NodeSet2 file, which load_nodesets reads as the same
/// nodes.
///
/// References to nodes of other namespaces are written too, unless the model of the other namespace
/// requires one that is written: they are in the file of that other model. Structures whose
/// DataType is unknown are written as bytes. Bad_NotFound for an index without a namespace.
[[nodiscard]] BUSBAR_API Result<std::string>
write_nodeset(const SpaceReader& space, std::span<const std::uint16_t> namespaces,
              const NodeSetExtras& extras = {});

} // namespace busbar::model
