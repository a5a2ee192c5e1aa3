#include "table.hpp"

#include <algorithm>
#include <numeric>

#include "display_text.hpp"

namespace busbar::tool {

namespace {

std::string padded(const Output& out, const Cell& cell, std::size_t width, const Column& column,
                   bool is_last)
{
    const std::string text = column.keeps_end ? cut_front(cell.text, width) : cut(cell.text, width);
    const std::string blanks(width - std::min(width, display_width(text)), ' ');
    const std::string shown = out.styled(cell.style, text);
    if (column.is_right) {
        return blanks + shown;
    }
    return is_last ? shown : shown + blanks;
}

} // namespace

std::vector<std::size_t> Table::widths(std::size_t columns) const
{
    std::vector<std::size_t> widths;
    std::vector<std::size_t> least;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        std::size_t width = display_width(columns_[i].title);
        least.push_back(std::max(columns_[i].min_width, width));
        for (const Row& row : rows_) {
            width = std::max(width, display_width(row.cells[i].text));
        }
        widths.push_back(width);
    }
    std::size_t total =
        std::accumulate(widths.begin(), widths.end(), column_gap * (widths.size() - 1));
    while (total > columns) {
        std::size_t widest = widths.size();
        for (std::size_t i = 0; i < widths.size(); ++i) {
            if (widths[i] > least[i] && (widest == widths.size() || widths[i] > widths[widest])) {
                widest = i;
            }
        }
        if (widest == widths.size()) {
            break; // nothing left to cut
        }
        --widths[widest];
        --total;
    }
    return widths;
}

std::vector<std::string> Table::lines(const Output& out, std::size_t columns) const
{
    const std::vector<std::size_t> width = widths(columns);
    const auto join = [&](const std::vector<Cell>& row) {
        std::string line;
        for (std::size_t i = 0; i < row.size(); ++i) {
            line += (i == 0 ? "" : std::string(column_gap, ' ')) +
                    padded(out, row[i], width[i], columns_[i], i + 1 == row.size());
        }
        line.erase(line.find_last_not_of(' ') + 1);
        return line;
    };
    std::vector<Cell> titles;
    for (const Column& column : columns_) {
        titles.push_back({column.title, Style::Bold});
    }
    std::vector<std::string> result{join(titles)};
    for (const Row& row : rows_) {
        result.push_back(join(row.cells));
        result.insert(result.end(), row.below.begin(), row.below.end());
    }
    return result;
}

void Table::print(Output& out) const
{
    for (const std::string& line : lines(out, out.columns())) {
        out.line(line);
    }
}

} // namespace busbar::tool
