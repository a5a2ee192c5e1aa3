#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "program_parts.hpp"

namespace busbar::controller::detail {

/// A cell of a table without its quotes and the blanks around it, and where it begins.
struct TableCell {
    std::string text{};
    std::size_t offset{0};
};

struct TableLine {
    std::vector<TableCell> cells{};
    /// The offset of its line feed, or of the end of the text.
    std::size_t end{0};
};

/// Says how the lines of a table are cut into cells.
struct TableForm {
    char separator{'\t'};
    /// True if a cell may be in quotes, within which it may have line feeds.
    bool has_quotes{false};
};
/// Cells after these are ignored.
inline constexpr std::size_t max_table_cells = 64;

/// Cuts the line that begins there.
[[nodiscard]] TableLine table_line(std::string_view text, std::size_t begin, TableForm form);

/// The declaration in a line of a table. All texts are as in declarations.
struct TableRow {
    TableCell name{};
    TableCell type{};
    TableCell initial{};
    /// The rest of the variable.
    GlobalVariable variable{};
    /// The reason why the line cannot be served, and the cell with that; empty if it can.
    std::string problem{};
    std::size_t problem_offset{0};
};

/// A table of variables, or of the members of a structure.
struct CellTable {
    TableForm form{};
    /// The offset of the first line after the titles.
    std::size_t begin{0};
    /// Makes a row of a line; without a name the line is skipped.
    std::function<TableRow(const TableLine& line)> row_of{};
    /// The name of the structure; empty: variables.
    std::string structure{};
};

/// Adds a table. A line with a mistake is left out with the place of its cell; a structure with one
/// is left out as a whole. The source must outlive the parts.
void add_table(const SourceText& source, CellTable table, ProgramParts& to);

/// Tells whether the text is a list of global labels, or of a structure's members, as GX Works2 and
/// GX Works3 export it: one of the first lines has the titles of the name and of the data type, in
/// English or Japanese.
[[nodiscard]] BUSBAR_API bool is_gx_table(std::string_view text);

/// Adds such a list. The source must outlive the parts.
[[nodiscard]] BUSBAR_API Configured<void> add_gx_table(const SourceText& source, ProgramParts& to);

/// Tells whether the text is a table of global variables as Sysmac Studio copies it: lines of cells
/// between tabs. The first line, or the second one after a line of titles, has a name, a type, and
/// TRUE or FALSE as its fifth and sixth cell.
[[nodiscard]] BUSBAR_API bool is_sysmac_table(std::string_view text);

/// Adds such a table. The source must outlive the parts.
[[nodiscard]] BUSBAR_API Configured<void> add_sysmac_table(const SourceText& source,
                                                           ProgramParts& to);

} // namespace busbar::controller::detail
