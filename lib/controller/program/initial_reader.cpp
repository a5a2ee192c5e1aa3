#include "declaration_cursor.hpp"

#include "expression.hpp"
#include "literal.hpp"

namespace busbar::controller::detail {

namespace {

/// Stores the value of an expression. A single name stays a name: what it stands for depends on the
/// type.
bool set_value(DeclarationCursor& cursor, ExpressionValue& result, InitialValue& value)
{
    if (result.is_later()) {
        return true;
    }
    if (!result.name.empty()) {
        value.value = Variant{String{result.name}};
        value.enumeration = std::move(result.enumeration);
        value.notation = InitialValue::Notation::Enumerator;
        return cursor.keep(value.enumeration.size() + result.name.size());
    }
    value.value = std::move(result.value);
    value.notation = result.notation;
    const auto* text = value.value.get_if<String>();
    return text == nullptr || cursor.keep(text->size());
}

bool read_constant(DeclarationCursor& cursor, InitialValue& value)
{
    ExpressionValue result;
    return read_expression(cursor, result) && set_value(cursor, result, value);
}

/// True before "(X :=", which is no expression in parentheses.
bool is_aggregate(const DeclarationCursor& cursor)
{
    DeclarationLexer lexer{cursor.rest()};
    return lexer.next().text == "(" && lexer.next().kind == DeclarationToken::Kind::Word &&
           lexer.next().text == ":=";
}

/// Reads "(X := 1, Y := 2)", whose opening parenthesis is taken.
bool read_aggregate(DeclarationCursor& cursor, InitialValue& value, std::size_t depth)
{
    do {
        InitialValue part;
        if (!cursor.keep(sizeof part) || !cursor.expect_name(part.member, "the name of a member") ||
            !cursor.expect_symbol(":=") || !read_initial_value(cursor, part, depth + 1)) {
            return false;
        }
        value.parts.push_back(std::move(part));
    } while (cursor.skip_symbol(","));
    return cursor.skip_symbol(")") || cursor.fail("',' or ')'");
}

/// Reads "3(0)" from its parenthesis on.
bool read_repeated(DeclarationCursor& cursor, const DeclarationToken& at,
                   const ExpressionValue& count, InitialValue& part, std::size_t depth)
{
    if (!require_value(cursor, count)) {
        return false;
    }
    const auto* whole = count.value.get_if<std::int64_t>();
    if (!count.is_later()) {
        if (whole == nullptr || *whole < 1 || *whole > INT32_MAX) {
            return cursor.fail_at(at, "a number of elements from 1 on");
        }
        part.repeat = static_cast<std::uint32_t>(*whole);
    }
    return cursor.skip_symbol(")") ||
           (read_initial_value(cursor, part, depth + 1) && cursor.expect_symbol(")"));
}

bool read_element(DeclarationCursor& cursor, InitialValue& part, std::size_t depth)
{
    if (cursor.is_symbol("[") || (cursor.is_symbol("(") && is_aggregate(cursor))) {
        return read_initial_value(cursor, part, depth + 1);
    }
    part.place = cursor.place();
    const DeclarationToken first = cursor.now();
    ExpressionValue result;
    if (!read_expression(cursor, result)) {
        return false;
    }
    return cursor.skip_symbol("(") ? read_repeated(cursor, first, result, part, depth)
                                   : set_value(cursor, result, part);
}

/// Reads "[1, 2, 3(0)]", whose opening bracket is taken.
bool read_list(DeclarationCursor& cursor, InitialValue& value, std::size_t depth)
{
    do {
        InitialValue part;
        if (!cursor.keep(sizeof part) || !read_element(cursor, part, depth)) {
            return false;
        }
        value.parts.push_back(std::move(part));
    } while (cursor.skip_symbol(","));
    return cursor.skip_symbol("]") || cursor.fail("',' or ']'");
}

} // namespace

bool read_initial_value(DeclarationCursor& cursor, InitialValue& value, std::size_t depth)
{
    value.place = cursor.place();
    const bool is_round = cursor.is_symbol("(");
    if (!cursor.is_symbol("[") && !(is_round && is_aggregate(cursor))) {
        return read_constant(cursor, value);
    }
    if (depth >= cursor.limits().max_depth) {
        return cursor.fail_with(cursor.now().offset,
                                "has more than " + std::to_string(cursor.limits().max_depth) +
                                    " aggregates and lists within one another");
    }
    const bool is_list = cursor.take().text == "[";
    return is_list ? read_list(cursor, value, depth) : read_aggregate(cursor, value, depth);
}

bool read_whole_number(DeclarationCursor& cursor, std::int64_t& number, std::string_view what)
{
    const DeclarationToken first = cursor.now();
    const bool can_begin = first.kind == DeclarationToken::Kind::Number ||
                           first.kind == DeclarationToken::Kind::Typed ||
                           first.kind == DeclarationToken::Kind::Word || cursor.is_symbol("-") ||
                           cursor.is_symbol("+") || cursor.is_symbol("(");
    if (!can_begin) {
        return cursor.fail(what);
    }
    ExpressionValue result;
    if (!read_expression(cursor, result) || !require_value(cursor, result)) {
        return false;
    }
    if (result.is_later()) {
        return true;
    }
    const auto* whole = result.value.get_if<std::int64_t>();
    if (whole == nullptr || result.notation != InitialValue::Notation::Number) {
        return cursor.fail_with(first.offset, found_expected(cursor.text_from(first.offset), what));
    }
    number = *whole;
    return true;
}

} // namespace busbar::controller::detail
