#include "cell_table.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <utility>

#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"
#include "literal.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

/// Removes the blanks around a cell, and moves its beginning.
void trim(TableCell& cell)
{
    const std::string_view whole = cell.text;
    const std::string_view inner = trimmed_text(whole);
    cell.offset += inner.empty() ? 0 : static_cast<std::size_t>(inner.data() - whole.data());
    cell.text = std::string{inner};
}

class TableReader {
public:
    TableReader(const SourceText& source, CellTable table)
        : source_{&source}, table_{std::move(table)}
    {
    }

    Configured<void> read(ReadingPass& pass)
    {
        pass_ = &pass;
        is_exhausted_ = false;
        structure_ = DerivedType{};
        structure_.name = table_.structure;
        structure_.kind = DerivedType::Kind::Structure;
        structure_.place = source_->places.at(table_.begin);
        has_left_out_ = false;
        for (std::size_t begin = table_.begin; begin < source_->text.size();) {
            const TableLine line = table_line(source_->text, begin, table_.form);
            TableRow row = table_.row_of(line);
            if (!row.name.text.empty() && !read_row(row) && !leave_out(row)) {
                return misconfigured(place_text(source_->file, place_), problem_);
            }
            begin = line.end + 1;
        }
        if (!table_.structure.empty() && !has_left_out_) {
            pass.program.types.push_back(std::move(structure_));
        }
        return {};
    }

private:
    bool fail(std::size_t offset, std::string text)
    {
        place_ = source_->places.at(offset);
        problem_ = std::move(text);
        return false;
    }

    bool keep(const TableCell& cell, std::size_t bytes)
    {
        is_exhausted_ = is_exhausted_ || !pass_->memory.take(bytes);
        return !is_exhausted_ ||
               fail(cell.offset, "takes more than " + std::to_string(pass_->limits.max_memory) +
                                     " bytes of memory up to here");
    }

    /// True if the cell is the text of the file, so that places in it are those in the file.
    [[nodiscard]] bool is_verbatim(const TableCell& cell) const
    {
        return source_->text.substr(std::min(cell.offset, source_->text.size()),
                                    cell.text.size()) == cell.text;
    }

    /// Lets `read` read a whole cell as part of a declaration.
    template <typename Read>
    bool read_cell(const TableCell& cell, Read read)
    {
        const bool has_places = is_verbatim(cell);
        DeclarationCursor cursor{has_places
                                     ? source_->text.substr(0, cell.offset + cell.text.size())
                                     : std::string_view{cell.text},
                                 {},
                                 has_places ? &source_->places : nullptr,
                                 pass_->limits,
                                 pass_->memory,
                                 pass_->constants,
                                 has_places ? cell.offset : 0};
        if (read(cursor) && (cursor.is_end() || cursor.fail("the end of the cell"))) {
            return true;
        }
        is_exhausted_ = is_exhausted_ || !cursor.can_recover();
        auto [words, place] = cursor.recover();
        fail(cell.offset, std::move(words));
        place_ = has_places ? place : place_;
        return false;
    }

    bool read_row(TableRow& row)
    {
        GlobalVariable& variable = row.variable;
        variable.place = source_->places.at(row.name.offset);
        variable.address.resize(std::min(variable.address.size(), pass_->limits.max_name_length));
        const std::size_t memory =
            sizeof variable + variable.address.size() + variable.comment.size();
        if (!row.problem.empty()) {
            return fail(row.problem_offset, std::move(row.problem));
        }
        if (!keep(row.name, memory) || !read_cell(row.name, [&](DeclarationCursor& cursor) {
                return cursor.expect_name(variable.name, "a name");
            })) {
            return false;
        }
        if (!read_cell(row.type, [&](DeclarationCursor& cursor) {
                return read_type_use(cursor, *pass_, variable.type);
            })) {
            return false;
        }
        if (!row.initial.text.empty() && !read_initial(row)) {
            return false;
        }
        if (table_.structure.empty()) {
            pass_->program.variables.push_back(std::move(variable));
        } else {
            structure_.members.push_back({.name = std::move(variable.name),
                                          .type = std::move(variable.type),
                                          .initial = std::move(variable.initial),
                                          .place = variable.place});
        }
        return true;
    }

    bool read_initial(TableRow& row)
    {
        const GlobalVariable& variable = row.variable;
        if (variable.is_constant) {
            if (!keep(row.initial, ConstantTable::memory_of_one + row.initial.text.size())) {
                return false;
            }
            pass_->constants.add_constant(
                {.name = variable.name, .text = lasting_text(row.initial), .place = variable.place},
                variable.type);
        }
        return read_cell(row.initial, [&](DeclarationCursor& cursor) {
            return read_initial_value(cursor, row.variable.initial);
        });
    }

    /// Returns the text of a cell, which lives as long as the parts do.
    std::string_view lasting_text(const TableCell& cell)
    {
        return is_verbatim(cell) ? source_->text.substr(cell.offset, cell.text.size())
                                 : std::string_view{texts_.emplace_back(cell.text)};
    }

    bool leave_out(const TableRow& row)
    {
        const bool is_member = !table_.structure.empty();
        const std::string_view name =
            is_member ? std::string_view{table_.structure}
                      : std::string_view{row.name.text}.substr(0, pass_->limits.max_name_length);
        if (pass_->unserved == Unserved::Refuse || is_exhausted_ ||
            !keep(row.name, sizeof(LeftOut) + problem_.size() + 2 * name.size())) {
            return false;
        }
        if (!is_member || !has_left_out_) {
            pass_->program.left_out.push_back(left_out(
                is_member ? LeftOut::Kind::Type : LeftOut::Kind::Variable, std::string{name},
                is_member ? NetworkPublish::Hidden : row.variable.publish, place_, problem_));
        }
        has_left_out_ = true;
        return true;
    }

    const SourceText* source_;
    CellTable table_;
    ReadingPass* pass_{nullptr};
    DerivedType structure_{};
    bool has_left_out_{false};
    /// Texts of constants that are not as in the file.
    std::deque<std::string> texts_{};
    std::string problem_{};
    ProgramPlace place_{};
    bool is_exhausted_{false};
};

} // namespace

TableLine table_line(std::string_view text, std::size_t begin, TableForm form)
{
    TableLine line{.cells = {TableCell{.text = {}, .offset = begin}}, .end = begin};
    bool is_quoted = false;
    for (; line.end < text.size(); ++line.end) {
        const char c = text[line.end];
        TableCell& cell = line.cells.back();
        const bool is_quote = form.has_quotes && c == '"';
        if (is_quoted && is_quote && text.substr(line.end + 1, 1) == "\"") {
            cell.text += c;
            ++line.end;
        } else if (is_quote && (is_quoted || trimmed_text(cell.text).empty())) {
            is_quoted = !is_quoted;
            cell = is_quoted ? TableCell{.text = {}, .offset = line.end + 1} : std::move(cell);
        } else if (!is_quoted && c == '\n') {
            break;
        } else if (!is_quoted && c == form.separator) {
            if (line.cells.size() < max_table_cells) {
                line.cells.push_back({.text = {}, .offset = line.end + 1});
            }
        } else if (c != '\r') {
            cell.text += c;
        }
    }
    for (TableCell& cell : line.cells) {
        trim(cell);
    }
    return line;
}

void add_table(const SourceText& source, CellTable table, ProgramParts& to)
{
    const auto reader = std::make_shared<TableReader>(source, std::move(table));
    to.list.push_back({source.file, [reader](ReadingPass& pass) { return reader->read(pass); }});
}

} // namespace busbar::controller::detail
