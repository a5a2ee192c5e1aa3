#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/controller/mapping.hpp>
#include <busbar/controller/model_report.hpp>
#include <busbar/core/api.hpp>
#include <busbar/model/space_reader.hpp>

/// The mapping as a table for spreadsheets: CSV as RFC 4180 has it, in UTF-8.
///
///     NodeId,Path,Part,Label,Rank,Dim1,Dim2,Dim3
///     nsu=urn:cell;i=5,/Objects/1:Cell/1:Speeds,,,1,3,,
///     nsu=urn:cell;i=5,/Objects/1:Cell/1:Speeds,[0],Line.Speed[0],,,,
///     nsu=urn:cell;i=9,/Objects/1:Cell/1:Start,Handle,StartHandle,,,,
///     nsu=urn:cell;i=9,/Objects/1:Cell/1:Start,Input[0].Name,Order.Name,,,,
///
/// A line for each label, and for each array specification one of its own. Part is as part_path has
/// it; of a Method it begins with "Handle", or with "Input" and the number of the argument.
namespace busbar::controller {

class ModelSet;

struct MappingTableLimits {
    std::size_t max_size{256U << 20U};
    std::size_t max_lines{8'000'000};
    /// Bytes of one field.
    std::size_t max_field{16'384};
    /// Elements and fields within one another.
    std::size_t max_part_levels{64};
    /// The number of an element is below.
    std::uint32_t max_elements{1'000'000};
};

/// Ordered by namespace and NodeId. With the mapping of all nodes of `mapping` that are in `space`.
[[nodiscard]] BUSBAR_API std::string write_mapping_table(const model::SpaceReader& space,
                                                         const Mapping& mapping);

/// The same with a line for each part of a node that could have a label (see MappableParts), and a
/// column Type.
[[nodiscard]] BUSBAR_API std::string write_mappable_table(const ModelSet& models);

struct ReadMappingTable {
    /// Of the lines without an error.
    Mapping mapping{};
    /// `where` of each: "line 7".
    ModelReports reports{};
};

/// Reads a table with the columns in any order, of which NodeId or Path, and Part and Label must be
/// there; others mean nothing. Fields are parted by commas or, if the header is, by semicolons or
/// tabs, as spreadsheets of many countries write; a byte order mark in front is passed over.
///
/// A node is found by NodeId, with "nsu=" or "ns=", or where that is empty by Path from the Root:
/// "/Objects/2:Cell/2:Speed" in the text format of RelativePath (Part 4, A.2). Lines without label
/// and array specification mean nothing, as do empty ones.
[[nodiscard]] BUSBAR_API ReadMappingTable read_mapping_table(std::string_view text,
                                                             const model::SpaceReader& space,
                                                             const MappingTableLimits& limits = {});

/// The node that a field of the column NodeId, or from a slash on of Path, names; no_node if there
/// is none.
[[nodiscard]] BUSBAR_API model::NodeIndex find_table_node(std::string_view text,
                                                          const model::SpaceReader& space);

} // namespace busbar::controller
