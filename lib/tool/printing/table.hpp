#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "json_writer.hpp"
#include "output.hpp"
#include "tool/connection/context.hpp"

namespace busbar::tool {

struct Column {
    std::string title;
    /// Never cut below this.
    std::size_t min_width{8};
    bool is_right{false};
    /// Cut at the front.
    bool keeps_end{false};
};

/// `safe` text.
struct Cell {
    std::string text;
    Style style{Style::Plain};
};

/// Rows in aligned columns with two blanks between them. Where they are wider than the output, the
/// widest columns are cut.
class Table {
public:
    explicit Table(std::vector<Column> columns) : columns_{std::move(columns)} {}

    /// Adds a row with as many cells as there are columns.
    void add(std::vector<Cell> row) { rows_.push_back({std::move(row), {}}); }
    /// Adds a row with lines below it, which are printed unchanged.
    void add(std::vector<Cell> row, std::vector<std::string> below)
    {
        rows_.push_back({std::move(row), std::move(below)});
    }
    [[nodiscard]] std::size_t row_count() const { return rows_.size(); }
    /// The title and the rows.
    void print(Output& out) const;
    /// Returns the table as lines without line ends, for an output with this number of columns.
    [[nodiscard]] std::vector<std::string> lines(const Output& out, std::size_t columns) const;

private:
    struct Row {
        std::vector<Cell> cells;
        std::vector<std::string> below;
    };

    [[nodiscard]] std::vector<std::size_t> widths(std::size_t columns) const;

    std::vector<Column> columns_;
    std::vector<Row> rows_;
};

/// Prints rows: as JSON, for which `json` has the document, or as a table, or `nothing` instead of
/// a table without rows. Returns Good.
Exit print_rows(Context& context, const JsonLine& json, const Table& table,
                std::string_view nothing = {});

/// One thing that differs, with the text of each side; empty if a side does not have it.
struct Difference {
    std::string what;
    std::string first;
    std::string second;
};

/// Titles of the table, which are the names of the members in JSON in small letters.
struct DifferenceTitles {
    const char* what;
    const char* first;
    const char* second;
    /// Text in the table where a side does not have the row.
    const char* nothing{""};
};

/// Prints a table, or in JSON {"differences": [...], "isSame": false}; Failed if there is one.
Exit print_differences(Context& context, const std::vector<Difference>& differences,
                       const DifferenceTitles& titles);

} // namespace busbar::tool
