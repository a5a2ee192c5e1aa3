#include "sysmac_table.hpp"

#include <array>
#include <optional>
#include <utility>

#include "constant_table.hpp"
#include "core/ascii_case.hpp"
#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"
#include "enumerator_numbers.hpp"
#include "initial_reader.hpp"
#include "literal.hpp"
#include "program_problem.hpp"
#include "publish_attribute.hpp"
#include "text_places.hpp"

namespace busbar::controller::detail {

namespace {

enum Column : std::size_t { Named, Typed, Initial, At, Retain, Constant, Publish, Comment };
constexpr std::size_t columns = 8;

/// A cell without the blanks around it, and where it begins.
struct Cell {
    std::string_view text{};
    std::size_t offset{0};
};
using Row = std::array<Cell, columns>;

/// Cuts a line into cells; what follows the last one is ignored.
Row cells_of(std::string_view text, std::size_t begin, std::size_t end)
{
    Row row;
    std::size_t at = begin;
    for (Cell& cell : row) {
        const std::size_t tab = std::min(text.find('\t', at), end);
        const std::string_view whole = text.substr(at, tab - at);
        cell.text = trimmed_text(whole);
        cell.offset =
            cell.text.empty() ? at : at + static_cast<std::size_t>(cell.text.data() - whole.data());
        at = std::min(tab + 1, end);
    }
    return row;
}

std::optional<bool> flag_of(const Cell& cell)
{
    if (busbar::detail::is_same_ignoring_case(cell.text, "TRUE")) {
        return true;
    }
    const bool is_false =
        cell.text.empty() || busbar::detail::is_same_ignoring_case(cell.text, "FALSE");
    return is_false ? std::optional{false} : std::nullopt;
}

bool is_row(const Row& row)
{
    return !row[Named].text.empty() && !row[Typed].text.empty() && flag_of(row[Retain]) &&
           !row[Retain].text.empty() && flag_of(row[Constant]) && !row[Constant].text.empty();
}

/// Returns the end of the line that begins there, without its line feed.
std::size_t end_of_line(std::string_view text, std::size_t begin)
{
    return std::min(text.find('\n', begin), text.size());
}

class TableReader {
public:
    TableReader(std::string_view text, std::string_view file_name, const TextPlaces& places,
                const DeclarationLimits& limits, ConstantTable& constants, Unserved unserved)
        : text_{text}, file_name_{file_name}, places_{&places}, limits_{&limits},
          memory_{limits.max_memory}, constants_{&constants}, unserved_{unserved}
    {
    }

    Configured<Program> read()
    {
        for (std::size_t begin = 0; begin < text_.size();) {
            const std::size_t end = end_of_line(text_, begin);
            const Row row = cells_of(text_, begin, end);
            // The first line may have the titles.
            const bool is_skipped = row[Named].text.empty() || (begin == 0 && !is_row(row));
            if (!is_skipped && !read_row(row) && !leave_out(row)) {
                return Unexpected<Problem>{
                    Problem{.where = place_text(file_name_, place_), .text = problem_}};
            }
            begin = end + 1;
        }
        return std::move(program_);
    }

private:
    bool fail(std::size_t offset, std::string text)
    {
        place_ = places_->at(offset);
        problem_ = std::move(text);
        return false;
    }

    bool keep(const Cell& cell, std::size_t bytes)
    {
        is_exhausted_ = is_exhausted_ || !memory_.take(bytes);
        return !is_exhausted_ ||
               fail(cell.offset, "takes more than " + std::to_string(limits_->max_memory) +
                                     " bytes of memory up to here");
    }

    /// Lets `read` read a whole cell as part of a declaration.
    template <typename Read>
    bool read_cell(const Cell& cell, Read read)
    {
        DeclarationCursor cursor{text_.substr(0, cell.offset + cell.text.size()),
                                 {},
                                 places_,
                                 *limits_,
                                 memory_,
                                 *constants_,
                                 cell.offset};
        if (read(cursor) && (cursor.is_end() || cursor.fail("the end of the cell"))) {
            return true;
        }
        is_exhausted_ = is_exhausted_ || !cursor.can_recover();
        auto [words, place] = cursor.recover();
        problem_ = std::move(words);
        place_ = place;
        return false;
    }

    bool read_flags(const Row& row, GlobalVariable& variable)
    {
        for (const auto& [column, flag] : {std::pair{Retain, &variable.is_retained},
                                           std::pair{Constant, &variable.is_constant}}) {
            const auto found = flag_of(row[column]);
            if (!found) {
                return fail(row[column].offset, found_expected(row[column].text, "True or False"));
            }
            *flag = *found;
        }
        if (row[Publish].text.empty()) {
            return true;
        }
        const auto publish = publish_of(row[Publish].text);
        variable.publish = publish.value_or(NetworkPublish::Hidden);
        return publish.has_value() ||
               fail(row[Publish].offset,
                    found_expected(row[Publish].text,
                                   "Do not publish, Publish Only, Input or Output"));
    }

    bool read_row(const Row& row)
    {
        GlobalVariable variable;
        variable.place = places_->at(row[Named].offset);
        const auto read_name = [&](DeclarationCursor& cursor) {
            return cursor.expect_name(variable.name, "the name of a variable");
        };
        const auto read_type = [&](DeclarationCursor& cursor) {
            return read_type_use(cursor, unserved_, variable.type);
        };
        const auto read_value = [&](DeclarationCursor& cursor) {
            return read_initial_value(cursor, variable.initial);
        };
        if (!keep(row[Named], sizeof variable + row[At].text.size() + row[Comment].text.size()) ||
            !read_flags(row, variable) || !read_cell(row[Named], read_name) ||
            !read_cell(row[Typed], read_type)) {
            return false;
        }
        if (variable.is_constant) {
            constants_->add_constant(
                {.name = variable.name, .text = row[Initial].text, .place = variable.place},
                variable.type);
        }
        if (!row[Initial].text.empty() && !read_cell(row[Initial], read_value)) {
            return false;
        }
        variable.address = row[At].text.substr(0, limits_->max_name_length);
        variable.comment = row[Comment].text;
        program_.variables.push_back(std::move(variable));
        return true;
    }

    bool leave_out(const Row& row)
    {
        const std::string_view name = row[Named].text.substr(0, limits_->max_name_length);
        if (unserved_ == Unserved::Refuse || is_exhausted_ ||
            !keep(row[Named], sizeof(LeftOut) + problem_.size() + 2 * name.size())) {
            return false;
        }
        const NetworkPublish publish =
            publish_of(row[Publish].text).value_or(NetworkPublish::Hidden);
        program_.left_out.push_back(
            left_out(LeftOut::Kind::Variable, std::string{name}, publish, place_, problem_));
        return true;
    }

    std::string_view text_;
    std::string_view file_name_;
    const TextPlaces* places_;
    const DeclarationLimits* limits_;
    MemoryBudget memory_;
    ConstantTable* constants_;
    Unserved unserved_;
    Program program_{};
    std::string problem_{};
    ProgramPlace place_{};
    bool is_exhausted_{false};
};

} // namespace

bool is_sysmac_table(std::string_view text)
{
    const std::size_t first = end_of_line(text, 0);
    const std::size_t second = std::min(first + 1, text.size());
    return is_row(cells_of(text, 0, first)) ||
           is_row(cells_of(text, second, end_of_line(text, second)));
}

Configured<Program> read_sysmac_table(std::string_view text, std::string_view file_name,
                                      const DeclarationLimits& limits, Unserved unserved)
{
    const TextPlaces places{text};
    ConstantTable constants;
    constants.set_file(file_name);
    auto program = read_in_passes(constants, unserved, [&](Unserved choice) {
        return TableReader{text, file_name, places, limits, constants, choice}.read();
    });
    if (program) {
        settle_enumerators(*program);
    }
    return program;
}

} // namespace busbar::controller::detail
