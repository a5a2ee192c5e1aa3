#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/controller/text_encoding.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/array.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/types/data_types.hpp>

/// The mapping as a table for spreadsheets: CSV (RFC 4180), written in UTF-8.
///
///     NodeId,Path,Part,Label,Rank,Dim1,Dim2,Dim3
///     nsu=urn:cell;i=5,/Objects/1:Cell/1:Speeds,,,1,3,,
///     nsu=urn:cell;i=5,/Objects/1:Cell/1:Speeds,[0],Line.Speed[0],,,,
///     nsu=urn:cell;i=9,/Objects/1:Cell/1:Start,Handle,StartHandle,,,,
///     nsu=urn:cell;i=9,/Objects/1:Cell/1:Start,Input[0].Name,Order.Name,,,,
///
/// There is one line for each label, and a separate one for each array specification. Part is as in
/// part_path; for a Method it begins with "Handle", or with "Input" and the number of the argument.
/// The part "Roles" of any node has its RolePermissions in place of a label, see roles_text().
namespace busbar::controller {

class ModelSet;

/// The limits of a table that is read.
struct MappingTableLimits {
    std::size_t max_size{256U << 20U};
    std::size_t max_lines{8'000'000};
    /// Bytes of one field.
    std::size_t max_field{16'384};
    /// Nested elements and fields.
    std::size_t max_part_levels{64};
    /// The upper bound of an element's number, exclusive.
    std::uint32_t max_elements{1'000'000};
};

/// Ordered by namespace and NodeId. Contains the mapping of all nodes of `mapping` that are in
/// `space`, and the RolePermissions of all nodes of models.
[[nodiscard]] BUSBAR_API std::string write_mapping_table(const model::SpaceReader& space,
                                                         const Mapping& mapping);

/// The parts that a table of mappable parts has: all, or only those that have no label yet.
enum class PartsWritten : std::uint8_t { All, Unmapped };

/// Writes also a line for each part of a node that could have a label (see MappableParts), and a
/// column Type.
[[nodiscard]] BUSBAR_API std::string write_mappable_table(const ModelSet& models,
                                                          PartsWritten written = PartsWritten::All);

/// A line of the part "Roles".
struct TableRoles {
    /// The node, which has a part of this kind once.
    NodeId node;
    /// Its RolePermissions.
    Array<RolePermissionType> roles;
};

/// The result of reading a table.
struct ReadMappingTable {
    /// The mapping of all lines without an error.
    Mapping mapping{};
    /// Each node once.
    std::vector<TableRoles> roles{};
    /// `where` is "line 7", for example.
    ModelReports reports{};
    /// The encoding of the table.
    TextEncoding encoding{TextEncoding::Utf8};
};

/// Reads a table with the columns in any order; Part, Label and either NodeId or Path must exist;
/// others are ignored. Fields are separated by commas or, if the header's are, by semicolons or
/// tabs, as spreadsheets of many countries write. The text is in any encoding that decode_text
/// recognizes.
///
/// A node is identified by NodeId, with "nsu=" or "ns=", or if that is empty by Path from the Root:
/// "/Objects/2:Cell/2:Speed" in the text format of RelativePath (Part 4, A.2). Lines without label
/// and array specification are ignored, as are empty ones.
[[nodiscard]] BUSBAR_API ReadMappingTable read_mapping_table(std::string_view text,
                                                             const model::SpaceReader& space,
                                                             const MappingTableLimits& limits = {});

/// Returns the node that a field of the column NodeId, or of Path if it begins with a slash, names;
/// no_node if there is none.
[[nodiscard]] BUSBAR_API model::NodeIndex find_table_node(std::string_view text,
                                                          const model::SpaceReader& space);

} // namespace busbar::controller
