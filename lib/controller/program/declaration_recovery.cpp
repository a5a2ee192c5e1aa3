#include <algorithm>
#include <array>
#include <utility>

#include <busbar/controller/program_types.hpp>

#include "declaration_parser.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

namespace {

/// Words that begin a block and are no names.
constexpr std::array<std::string_view, 8> block_begins{
    "CONFIGURATION", "DATA_BLOCK", "FUNCTION_BLOCK", "PROGRAM",
    "TYPE",          "VAR_ACCESS", "VAR_CONFIG",     "VAR_GLOBAL",
};
constexpr std::array<std::string_view, 11> block_ends{
    "END_CLASS",          "END_CONFIGURATION", "END_DATA_BLOCK", "END_FUNCTION",
    "END_FUNCTION_BLOCK", "END_INTERFACE",     "END_NAMESPACE",  "END_PROGRAM",
    "END_RESOURCE",       "END_TYPE",          "END_VAR",
};

/// The units of IEC 61131-3, 3rd edition, 6.6, with statements or prototypes, and their parts,
/// which some tools export to files of their own.
struct UnitRow {
    std::string_view first;
    std::string_view last;
    std::string_view words;
};
constexpr std::array unit_rows{
    UnitRow{"FUNCTION_BLOCK", "END_FUNCTION_BLOCK", "is a function block"},
    // The word of CoDeSys 2 for those in ladder diagram.
    UnitRow{"FUNCTIONBLOCK", "END_FUNCTION_BLOCK", "is a function block"},
    UnitRow{"FUNCTION", "END_FUNCTION", "is a function"},
    UnitRow{"PROGRAM", "END_PROGRAM", "is a program"},
    UnitRow{"CLASS", "END_CLASS", "is a class"},
    UnitRow{"INTERFACE", "END_INTERFACE", "is an interface"},
    UnitRow{"ORGANIZATION_BLOCK", "END_ORGANIZATION_BLOCK", "is an organization block"},
    UnitRow{"METHOD", "END_METHOD", "is a method"},
    UnitRow{"PROPERTY", "END_PROPERTY", "is a property"},
    UnitRow{"ACTION", "END_ACTION", "is an action"},
};

constexpr std::array<std::string_view, 7> unit_modifiers{
    "ABSTRACT", "FINAL", "INTERNAL", "OVERRIDE", "PRIVATE", "PROTECTED", "PUBLIC",
};

template <std::size_t n>
bool is_at_one_of(const DeclarationCursor& cursor, const std::array<std::string_view, n>& words)
{
    return cursor.now().kind == DeclarationToken::Kind::Word &&
           std::any_of(words.begin(), words.end(),
                       [&](std::string_view word) { return cursor.is_word(word); });
}

} // namespace

bool DeclarationParser::leave_out(LeftOut::Kind kind)
{
    if (!leaves_out_ || !cursor_->can_recover()) {
        return false;
    }
    // A text without an end has taken the rest of its line, with the declaration's semicolon.
    const bool is_line_lost = cursor_->now().kind == DeclarationToken::Kind::Wrong && depth_ == 0;
    const auto [text, place] = cursor_->recover();
    if (declaring_.empty()) {
        declaring_.push_back({.text = {}, .place = place});
        kind = LeftOut::Kind::Part;
    }
    for (Name& name : declaring_) {
        if (!note(kind, std::move(name.text), place, text)) {
            return false;
        }
    }
    declaring_.clear();
    // Whatever the text is, reading it comes to an end.
    const std::size_t here = cursor_->now().offset;
    if (std::exchange(last_problem_, here) == here) {
        cursor_->take();
        cursor_->pass_wrong();
    }
    if (!is_line_lost) {
        skip_declaration();
    }
    depth_ = 0;
    return true;
}

bool DeclarationParser::note(LeftOut::Kind kind, std::string name, const ProgramPlace& place,
                             const std::string& text)
{
    const std::size_t memory = sizeof(LeftOut) + 2 * name.size() + text.size();
    if (!cursor_->keep(memory)) {
        return false;
    }
    program().left_out.push_back(left_out(kind, std::move(name), declaring_publish_, place, text));
    return true;
}

void DeclarationParser::skip_declaration()
{
    while (!is_after_block() && !is_at_one_of(*cursor_, block_ends)) {
        const bool is_open = cursor_->is_word("STRUCT") || cursor_->is_word("UNION");
        const bool is_closed = cursor_->is_word("END_STRUCT") || cursor_->is_word("END_UNION");
        const bool is_semicolon = cursor_->is_symbol(";");
        cursor_->take();
        cursor_->pass_wrong();
        depth_ += is_open ? 1 : 0;
        depth_ -= is_closed && depth_ > 0 ? 1 : 0;
        if (depth_ > 0) {
            continue;
        }
        // Vendors omit the semicolon after the word that closes a structure.
        const bool is_end = is_closed && !cursor_->is_symbol(":=");
        if (is_end) {
            cursor_->skip_symbol(";");
        }
        if (is_end || is_semicolon) {
            return;
        }
    }
}

void DeclarationParser::skip_to_block()
{
    while (!is_after_block()) {
        cursor_->take();
        cursor_->pass_wrong();
    }
}

bool DeclarationParser::is_after_block() const
{
    return cursor_->is_end() || is_at_one_of(*cursor_, block_begins);
}

bool DeclarationParser::is_out_of_block(std::string_view last) const
{
    return is_after_block() || (is_at_one_of(*cursor_, block_ends) && !cursor_->is_word(last));
}

bool DeclarationParser::read_beside(bool& is_part)
{
    is_part = leaves_out_;
    if (!is_part) {
        return false;
    }
    for (const UnitRow& row : unit_rows) {
        if (cursor_->skip_word(row.first)) {
            return skip_unit(row.last, row.words);
        }
    }
    if (cursor_->skip_word("NAMESPACE")) {
        return enter_namespace();
    }
    // Automation Studio of B&R writes global variables so, in a file of their own (.var).
    if (cursor_->skip_word("VAR")) {
        return read_variables(NetworkPublish::Hidden);
    }
    if (cursor_->skip_word("VAR_CONFIG") || cursor_->skip_word("VAR_ACCESS")) {
        return skip_variables();
    }
    if (cursor_->skip_word("USING")) {
        skip_declaration();
        return true;
    }
    // The ends of what was left because of a mistake in it, and of a namespace.
    is_part = cursor_->skip_word("END_NAMESPACE") || cursor_->skip_word("END_RESOURCE") ||
              cursor_->skip_word("END_CONFIGURATION");
    return is_part;
}

bool DeclarationParser::skip_unit(std::string_view last, std::string_view words)
{
    while (is_at_one_of(*cursor_, unit_modifiers)) {
        cursor_->take();
    }
    Name name{.text = {}, .place = cursor_->place()};
    if (!cursor_->expect_name(name.text, "the name of a unit") ||
        !note(LeftOut::Kind::Unit, std::move(name.text), name.place, std::string{words})) {
        return false;
    }
    bool is_member = false;
    while (!cursor_->is_end() && (is_member || !is_after_block())) {
        if (!is_member && cursor_->skip_word(last)) {
            return true;
        }
        is_member = cursor_->is_symbol(".");
        cursor_->take();
        cursor_->pass_wrong();
    }
    return true;
}

bool DeclarationParser::skip_variables()
{
    while (!cursor_->skip_word("END_VAR") && !is_after_block()) {
        cursor_->take();
        cursor_->pass_wrong();
    }
    return true;
}

bool DeclarationParser::enter_namespace()
{
    if (!cursor_->skip_word("INTERNAL")) {
        cursor_->skip_word("PUBLIC");
    }
    std::string name;
    do {
        if (!cursor_->expect_name(name, "the name of a namespace")) {
            return false;
        }
        pass_->namespaces.insert(fold_name(name));
    } while (cursor_->skip_symbol("."));
    return true;
}

void DeclarationParser::skip_semicolons()
{
    while (cursor_->is_symbol(";")) {
        cursor_->take();
    }
}

bool DeclarationParser::read_qualified(TypeUse& use)
{
    const std::size_t offset = cursor_->now().offset;
    std::string qualifier;
    while (cursor_->expect_name(use.type_name, "a type")) {
        if (!leaves_out_ || !cursor_->skip_symbol(".")) {
            use.type_name.insert(0, qualifier);
            return !leaves_out_ || !cursor_->is_symbol("(") ||
                   cursor_->fail_with(offset, "is of the type " + quoted_name(use.type_name) +
                                                  " with arguments, which is not served");
        }
        qualifier += use.type_name + ".";
    }
    return false;
}

} // namespace busbar::controller::detail
