#include <algorithm>
#include <array>
#include <span>

#include <busbar/controller/program_types.hpp>

#include "core/ascii_case.hpp"
#include "declaration_cursor.hpp"
#include "declaration_parser.hpp"

// What the sources of TIA Portal (.scl, .udt, .db) have beside IEC 61131-3; see SIEMENS_SCL.md.
namespace busbar::controller::detail {

namespace {

/// Words of a block's header, each followed by ":" or "=" and a value.
constexpr std::array<std::string_view, 4> header_words{
    "AUTHOR",
    "FAMILY",
    "NAME",
    "VERSION",
};
constexpr std::array<std::string_view, 5> header_marks{
    "DB_SPECIFIC", "KNOW_HOW_PROTECT", "NON_RETAIN", "STANDARD", "UNLINKED",
};

bool is_word_of(std::span<const std::string_view> words, std::string_view word)
{
    return std::any_of(words.begin(), words.end(), [&](std::string_view one) {
        return busbar::detail::is_same_ignoring_case(one, word);
    });
}

/// True for the pragma of a data block that OPC UA has no access to.
bool is_hidden_block(std::string_view pragma)
{
    constexpr std::string_view name = "DB_Accessible_From_OPC_UA";
    const std::size_t at = pragma.find(name);
    if (at == pragma.npos) {
        return false;
    }
    std::string_view value = pragma.substr(at + name.size());
    value = value.substr(0, value.find(';'));
    const std::size_t quote = std::min(value.find('\''), value.size());
    return busbar::detail::is_same_ignoring_case(value.substr(quote, 7), "'FALSE'");
}

} // namespace

bool DeclarationParser::skip_header(BlockHeader& header)
{
    while (true) {
        const DeclarationToken& now = cursor_->now();
        if (now.kind == DeclarationToken::Kind::Pragma) {
            header.is_hidden = header.is_hidden || is_hidden_block(now.text);
            cursor_->take();
        } else if (cursor_->skip_word("RETAIN")) {
            header.is_retained = true;
        } else if (cursor_->skip_word("READ_ONLY")) {
            header.is_read_only = true;
        } else if (cursor_->skip_word("TITLE")) {
            if (!cursor_->is_symbol(":") && !cursor_->is_symbol("=")) {
                return cursor_->fail("':' or '='");
            }
            cursor_->skip_line(); // a title is prose, without quotes
        } else if (now.kind == DeclarationToken::Kind::Word && is_word_of(header_marks, now.text)) {
            cursor_->take();
        } else if (now.kind == DeclarationToken::Kind::Word && is_word_of(header_words, now.text)) {
            cursor_->take();
            if (!cursor_->skip_symbol(":") && !cursor_->skip_symbol("=")) {
                return cursor_->fail("':' or '='");
            }
            cursor_->take();
            cursor_->skip_symbol(";");
        } else {
            return true;
        }
    }
}

bool DeclarationParser::read_data_block()
{
    declaring_.clear();
    declaring_publish_ = NetworkPublish::Hidden;
    GlobalVariable variable;
    BlockHeader header;
    if (!read_names(declaring_, "the name of a data block")) {
        return false;
    }
    path_ = declaring_.front().text;
    if (!skip_header(header)) {
        return false;
    }
    variable.publish = header.is_hidden ? NetworkPublish::Hidden : NetworkPublish::PublishOnly;
    variable.is_constant = header.is_read_only;
    variable.is_retained = header.is_retained;
    declaring_publish_ = variable.publish;
    if (!read_block_type(variable.type) || !read_start_values(variable.initial)) {
        return false;
    }
    return add_variables(variable);
}

bool DeclarationParser::read_block_type(TypeUse& use)
{
    if (!cursor_->is_word("VAR")) { // a structure, or the name of a type or a function block
        const bool is_read = read_use(use);
        skip_semicolons();
        return is_read;
    }
    DerivedType type{.name = path_ + ".STRUCT", .place = cursor_->place()};
    const std::size_t later = cursor_->constants().later_count();
    while (cursor_->skip_word("VAR")) {
        // Not skip_header(), whose words may be names of members.
        while (cursor_->is_word("RETAIN") || cursor_->is_word("NON_RETAIN") ||
               cursor_->is_word("DB_SPECIFIC")) {
            cursor_->take();
        }
        if (!read_members(type, "END_VAR")) {
            return false;
        }
        skip_semicolons();
    }
    use.type_name = type.name;
    if (cursor_->constants().later_count() != later) {
        cursor_->constants().add_unsettled(fold_name(type.name));
    }
    if (!cursor_->keep(sizeof type + 2 * type.name.size())) {
        return false;
    }
    program().types.push_back(std::move(type));
    return true;
}

bool DeclarationParser::skip_data_block()
{
    while (!is_after_block() && !cursor_->skip_word("END_DATA_BLOCK")) {
        cursor_->take();
        cursor_->pass_wrong();
    }
    return true;
}

bool DeclarationParser::skip_start_value(const ProgramPlace& place)
{
    const std::string text = "is the start value of a part of a member, which is not read";
    if (!leaves_out_) {
        return cursor_->fail_with(cursor_->now().offset, text);
    }
    bool is_member = false; // which may be called Type, for example
    while (!cursor_->skip_symbol(";")) {
        const bool is_out =
            cursor_->is_end() ||
            (!is_member && (is_after_block() || cursor_->is_word("END_DATA_BLOCK")));
        if (is_out || cursor_->now().kind == DeclarationToken::Kind::Wrong) {
            return cursor_->fail("';'");
        }
        is_member = cursor_->is_symbol(".");
        cursor_->take();
    }
    return note(LeftOut::Kind::Part, {}, place, text);
}

bool DeclarationParser::read_start_values(InitialValue& initial)
{
    if (!cursor_->skip_word("BEGIN")) {
        return cursor_->skip_word("END_DATA_BLOCK") || cursor_->fail("BEGIN or END_DATA_BLOCK");
    }
    while (!cursor_->skip_word("END_DATA_BLOCK")) {
        const ProgramPlace place = cursor_->place();
        InitialValue value;
        if (!cursor_->expect_name(value.member, "the name of a member or END_DATA_BLOCK")) {
            return false;
        }
        const bool is_part = cursor_->is_symbol(".") || cursor_->is_symbol("[");
        if (is_part) {
            if (!skip_start_value(place)) {
                return false;
            }
            continue;
        }
        std::string member = std::move(value.member);
        if (!cursor_->expect_symbol(":=") || !read_initial_value(*cursor_, value) ||
            !cursor_->expect_symbol(";") || !cursor_->keep(memory_of(value))) {
            return false;
        }
        value.member = std::move(member);
        initial.parts.push_back(std::move(value));
    }
    return true;
}

} // namespace busbar::controller::detail
