#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace busbar::controller::detail {

/// The columns in the order in which they are written.
enum class TableColumn : std::size_t { NodeId, Path, Part, Label, Rank, Dim1, Dim2, Dim3 };
inline constexpr std::array<std::string_view, 8> table_columns{
    "NodeId", "Path", "Part", "Label", "Rank", "Dim1", "Dim2", "Dim3",
};

/// Beginnings of the names of a Method's parts.
inline constexpr std::string_view handle_part = "Handle";
inline constexpr std::string_view done_part = "Done";
inline constexpr std::string_view input_part = "Input";
inline constexpr std::string_view output_part = "Output";
/// Parts of a Variable in addition to those of its value. Scaling has a text instead of a label.
inline constexpr std::string_view quality_part = "Quality";
inline constexpr std::string_view scaling_part = "Scaling";
/// The RolePermissions of any node, as roles_text() writes them.
inline constexpr std::string_view roles_part = "Roles";

} // namespace busbar::controller::detail
