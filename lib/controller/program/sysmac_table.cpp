#include "cell_table.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/ascii_case.hpp"
#include "declaration_keywords.hpp"
#include "literal.hpp"

namespace busbar::controller::detail {

namespace {

enum Column : std::size_t { Named, Typed, Initial, At, Retain, Constant, Publish, Comment };
constexpr TableForm sysmac_form{.separator = '\t'};

const TableCell& cell(const TableLine& line, Column column)
{
    static const TableCell none{};
    return column < line.cells.size() ? line.cells[column] : none;
}

std::optional<bool> flag_of(const TableCell& cell)
{
    if (busbar::detail::is_same_ignoring_case(cell.text, "TRUE")) {
        return true;
    }
    const bool is_false =
        cell.text.empty() || busbar::detail::is_same_ignoring_case(cell.text, "FALSE");
    return is_false ? std::optional{false} : std::nullopt;
}

bool is_row(const TableLine& line)
{
    const auto has_flag = [&](Column column) {
        return !cell(line, column).text.empty() && flag_of(cell(line, column));
    };
    return !cell(line, Named).text.empty() && !cell(line, Typed).text.empty() && has_flag(Retain) &&
           has_flag(Constant);
}

TableRow sysmac_row(const TableLine& line)
{
    TableRow row{
        .name = cell(line, Named), .type = cell(line, Typed), .initial = cell(line, Initial)};
    const auto wrong = [&](Column column, std::string_view expected) {
        row.problem = found_expected(cell(line, column).text, expected);
        row.problem_offset = cell(line, column).offset;
    };
    GlobalVariable& variable = row.variable;
    variable.address = cell(line, At).text;
    variable.comment = cell(line, Comment).text;
    for (const auto& [column, flag] :
         {std::pair{Retain, &variable.is_retained}, std::pair{Constant, &variable.is_constant}}) {
        const auto found = flag_of(cell(line, column));
        *flag = found.value_or(false);
        if (!found) {
            wrong(column, "True or False");
        }
    }
    if (const std::string& words = cell(line, Publish).text; !words.empty()) {
        const auto publish = publish_of(words);
        variable.publish = publish.value_or(NetworkPublish::Hidden);
        if (!publish) {
            wrong(Publish, "Do not publish, Publish Only, Input or Output");
        }
    }
    return row;
}

} // namespace

bool is_sysmac_table(std::string_view text)
{
    constexpr std::size_t longest = 65'536;
    const std::string_view first_lines = text.substr(0, longest);
    const TableLine first = table_line(first_lines, 0, sysmac_form);
    const std::size_t second = std::min(first.end + 1, first_lines.size());
    return is_row(first) || is_row(table_line(first_lines, second, sysmac_form));
}

Configured<void> add_sysmac_table(const SourceText& source, ProgramParts& to)
{
    const TableLine first = table_line(source.text, 0, sysmac_form);
    add_table(
        source,
        {.form = sysmac_form, .begin = is_row(first) ? 0 : first.end + 1, .row_of = sysmac_row},
        to);
    return {};
}

} // namespace busbar::controller::detail
