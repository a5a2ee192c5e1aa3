#include "value_lines.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "display_text.hpp"
#include "output.hpp"

namespace busbar::tool {

namespace {

constexpr std::size_t indent_width = 2;
/// Names that are longer do not push the values of all others aside.
constexpr std::size_t max_name_columns = 32;
/// Width for arrays if none is given.
constexpr std::size_t usual_columns = 80;

std::string left(const std::string& text, std::size_t width)
{
    return text + std::string(width - std::min(width, display_width(text)), ' ');
}

std::string right(const std::string& text, std::size_t width)
{
    return std::string(width - std::min(width, display_width(text)), ' ') + text;
}

std::size_t widest(const std::vector<std::string>& cells)
{
    std::size_t width = 0;
    for (const std::string& cell : cells) {
        width = std::max(width, display_width(cell));
    }
    return width;
}

class LineWriter {
public:
    LineWriter(const ValueLimits& limits, std::size_t columns)
        : limit_{limits.count == 0 ? SIZE_MAX : limits.count}, cut_at_{limits.count == 0 ? SIZE_MAX
                                                                                         : columns},
          array_columns_{columns == SIZE_MAX ? usual_columns : columns}
    {
    }

    void write_below(const ValuePart& part, std::size_t indent)
    {
        write_cells(part, indent, widest(part.cells));
        write_parts(part, indent);
        if (part.left_out != 0) {
            add(std::string(indent, ' ') + rest(part.left_out, "elements"), SIZE_MAX);
        }
    }
    [[nodiscard]] std::vector<std::string> take()
    {
        if (dropped_ != 0) {
            lines_.push_back(std::string(indent_width, ' ') + rest(dropped_, "lines"));
        }
        return std::move(lines_);
    }

private:
    static std::string rest(std::size_t count, const std::string& of)
    {
        return "... " + std::to_string(count) + " more " + of + ", --limit 0 shows them";
    }
    void add(const std::string& line) { add(line, cut_at_); }
    void add(const std::string& line, std::size_t columns)
    {
        if (lines_.size() < limit_) {
            lines_.push_back(cut(line, columns));
        } else {
            ++dropped_;
        }
    }
    void write_parts(const ValuePart& part, std::size_t indent)
    {
        std::size_t name_width = 0;
        std::size_t cell_width = 0; // the same in all rows of a matrix
        for (const ValuePart& one : part.parts) {
            name_width = std::max(name_width, std::min(display_width(one.name), max_name_columns));
            cell_width = std::max(cell_width, widest(one.cells));
        }
        const bool is_matrix = !part.parts.empty() && part.parts.front().text.empty() &&
                               !part.parts.front().cells.empty();
        for (const ValuePart& one : part.parts) {
            const std::string name = std::string(indent, ' ') + left(one.name, name_width);
            if (is_matrix && fits(one, indent + name_width + column_gap, cell_width)) {
                add(name + std::string(column_gap, ' ') +
                    joined(one, 0, one.cells.size(), cell_width));
                continue;
            }
            std::string line = name + std::string(column_gap, ' ') + one.text;
            line.erase(line.find_last_not_of(' ') + 1);
            add(line);
            if (is_matrix) {
                write_cells(one, indent + indent_width, cell_width);
            } else {
                write_below(one, indent + indent_width);
            }
        }
    }
    [[nodiscard]] bool fits(const ValuePart& row, std::size_t used, std::size_t cell_width) const
    {
        return used + row.cells.size() * (cell_width + column_gap) <= array_columns_ + column_gap;
    }
    static std::string joined(const ValuePart& part, std::size_t first, std::size_t end,
                              std::size_t width)
    {
        std::string line;
        for (std::size_t i = first; i < end; ++i) {
            line += i == first ? "" : std::string(column_gap, ' ');
            line += part.has_numbers ? right(part.cells[i], width) : left(part.cells[i], width);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        return line;
    }
    /// Writes as many cells in a line as fit, with the index of the first in front.
    void write_cells(const ValuePart& part, std::size_t indent, std::size_t width)
    {
        if (part.cells.empty()) {
            return;
        }
        const std::size_t index_width = std::to_string(part.cells.size() - 1).size() + 2;
        const std::size_t used = indent + index_width;
        const std::size_t room = array_columns_ - std::min(array_columns_, used);
        const std::size_t fitting = std::max<std::size_t>(1, room / (width + column_gap));
        for (std::size_t first = 0; first < part.cells.size(); first += fitting) {
            const std::string index = "[" + std::to_string(first) + "]";
            const std::size_t end = std::min(first + fitting, part.cells.size());
            add(std::string(indent, ' ') + left(index, index_width) + std::string(column_gap, ' ') +
                joined(part, first, end, width));
        }
    }

    std::size_t limit_;
    std::size_t cut_at_;
    std::size_t array_columns_;
    std::vector<std::string> lines_;
    std::size_t dropped_{0};
};

} // namespace

void add_limit_option(CLI::App& command, ValueLimits& limits)
{
    command
        .add_option("--limit", limits.count,
                    "lines of a value and elements of an array to show; 0 for all")
        ->type_name("N")
        ->capture_default_str();
}

ValueText lines_of(const Variant& value, const Types& types, const ValueLimits& limits,
                   std::size_t columns, const NodeId& data_type)
{
    const ValuePart part = parts_of(value, types, limits.count, find_type(types, data_type));
    LineWriter writer{limits, columns};
    writer.write_below(part, indent_width);
    return {part.text, writer.take()};
}

ValueText lines_of(const DataValue& value, const Types& types, const ValueLimits& limits,
                   std::size_t columns, const NodeId& data_type)
{
    if (value.status.is_bad()) {
        return {text_of(value.status), {}};
    }
    return lines_of(value.value, types, limits, columns, data_type);
}

} // namespace busbar::tool
