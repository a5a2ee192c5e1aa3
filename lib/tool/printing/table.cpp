#include "table.hpp"

#include <algorithm>
#include <numeric>

#include "core/ascii_case.hpp"
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

std::string member_name(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), busbar::detail::to_ascii_lower);
    return text;
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

Exit print_rows(Context& context, const JsonLine& json, const Table& table,
                std::string_view nothing)
{
    if (context.options.is_json) {
        context.out.line(json.document());
    } else if (table.row_count() == 0 && !nothing.empty()) {
        context.out.line(nothing);
    } else {
        table.print(context.out);
    }
    return Exit::Good;
}

Exit print_differences(Context& context, const std::vector<Difference>& differences,
                       const DifferenceTitles& titles)
{
    JsonLine json;
    json.open_object().key("differences").open_array();
    Table table{
        {{titles.what, 24}, {titles.first, 16, false, true}, {titles.second, 16, false, true}}};
    for (const Difference& each : differences) {
        json.open_object().member(member_name(titles.what), each.what);
        json.member(member_name(titles.first), each.first);
        json.member(member_name(titles.second), each.second).close_object();
        table.add({{safe(each.what)},
                   {each.first.empty() ? titles.nothing : safe(each.first)},
                   {each.second.empty() ? titles.nothing : safe(each.second)}});
    }
    const bool is_same = differences.empty();
    json.close_array().member("isSame", is_same).close_object();
    print_rows(context, json, table, "no differences");
    return is_same ? Exit::Good : Exit::Failed;
}

} // namespace busbar::tool
