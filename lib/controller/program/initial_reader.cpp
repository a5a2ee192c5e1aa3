#include "initial_reader.hpp"

#include "core/ascii_case.hpp"
#include "declaration_keywords.hpp"
#include "literal.hpp"

namespace busbar::controller::detail {

namespace {

bool set_literal(DeclarationCursor& cursor, const DeclarationToken& token, LiteralResult literal,
                 InitialValue& value)
{
    if (!literal) {
        return cursor.fail_with(token.offset, std::move(literal).error());
    }
    value.value = std::move(literal->value);
    value.notation = literal->notation;
    const auto* text = value.value.get_if<String>();
    return text == nullptr || cursor.keep(text->size());
}

/// Stores the name of an enumerator, with or without the enumeration's name before it.
bool set_enumerator(DeclarationCursor& cursor, std::string_view enumeration, std::string_view name,
                    InitialValue& value)
{
    value.enumeration = enumeration;
    value.value = Variant{String{name}};
    value.notation = InitialValue::Notation::Enumerator;
    return cursor.keep(enumeration.size() + name.size());
}

bool is_enumerator(std::string_view word)
{
    const WordKind kind = kind_of_word(word);
    return kind == WordKind::Name || kind == WordKind::UnknownType;
}

bool read_word_value(DeclarationCursor& cursor, InitialValue& value)
{
    const bool is_true = cursor.is_word("TRUE");
    if (is_true || cursor.is_word("FALSE")) {
        cursor.take();
        value.value = Variant{is_true};
        value.notation = InitialValue::Notation::Number;
        return true;
    }
    if (!is_enumerator(cursor.now().text)) {
        return cursor.fail("a value");
    }
    const DeclarationToken first = cursor.take();
    if (!cursor.skip_symbol(".")) {
        return set_enumerator(cursor, {}, first.text, value);
    }
    if (cursor.now().kind != DeclarationToken::Kind::Word || !is_enumerator(cursor.now().text)) {
        return cursor.fail("the name of a value");
    }
    return set_enumerator(cursor, first.text, cursor.take().text, value);
}

bool read_typed_value(DeclarationCursor& cursor, InitialValue& value)
{
    const DeclarationToken token = cursor.take();
    if (auto literal = read_typed_literal(token.text)) {
        return set_literal(cursor, token, std::move(*literal), value);
    }
    const std::size_t hash = token.text.find('#');
    const std::string_view name = token.text.substr(hash + 1);
    const bool is_one_word = !name.empty() && (name.front() < '0' || name.front() > '9') &&
                             name.find_first_of("#.:+-\"'") == std::string_view::npos;
    if (!is_one_word || !is_enumerator(token.text.substr(0, hash)) || !is_enumerator(name)) {
        return cursor.fail_at(token, "the name of a type, '#' and a value of it");
    }
    return set_enumerator(cursor, token.text.substr(0, hash), name, value);
}

bool read_constant(DeclarationCursor& cursor, InitialValue& value)
{
    const bool is_negative = cursor.is_symbol("-");
    if (is_negative || cursor.is_symbol("+")) {
        cursor.take();
        if (cursor.now().kind != DeclarationToken::Kind::Number) {
            return cursor.fail("a number");
        }
    }
    switch (cursor.now().kind) {
    case DeclarationToken::Kind::Number: {
        const DeclarationToken token = cursor.take();
        return set_literal(cursor, token, read_number_literal(token.text, is_negative), value);
    }
    case DeclarationToken::Kind::Text: {
        const DeclarationToken token = cursor.take();
        return set_literal(cursor, token, read_text_literal(token.text), value);
    }
    case DeclarationToken::Kind::Typed:
        return read_typed_value(cursor, value);
    case DeclarationToken::Kind::Word:
        return read_word_value(cursor, value);
    default:
        return cursor.fail("a value");
    }
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
bool read_repeated(DeclarationCursor& cursor, const DeclarationToken& count, InitialValue& part,
                   std::size_t depth)
{
    const auto number = read_number_literal(count.text, false);
    const auto* whole = number ? number->value.get_if<std::int64_t>() : nullptr;
    if (whole == nullptr || *whole < 1 || *whole > INT32_MAX) {
        return cursor.fail_at(count, "a number of elements from 1 on");
    }
    part.repeat = static_cast<std::uint32_t>(*whole);
    return cursor.skip_symbol(")") ||
           (read_initial_value(cursor, part, depth + 1) && cursor.expect_symbol(")"));
}

bool read_element(DeclarationCursor& cursor, InitialValue& part, std::size_t depth)
{
    if (cursor.now().kind != DeclarationToken::Kind::Number) {
        return read_initial_value(cursor, part, depth + 1);
    }
    part.place = cursor.place();
    const DeclarationToken number = cursor.take();
    return cursor.skip_symbol("(")
               ? read_repeated(cursor, number, part, depth)
               : set_literal(cursor, number, read_number_literal(number.text, false), part);
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
    if (!cursor.is_symbol("(") && !cursor.is_symbol("[")) {
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
    InitialValue value;
    const bool is_number = first.kind == DeclarationToken::Kind::Number ||
                           first.kind == DeclarationToken::Kind::Typed || cursor.is_symbol("-") ||
                           cursor.is_symbol("+");
    if (!is_number) {
        return cursor.fail(what);
    }
    if (!read_constant(cursor, value)) {
        return false;
    }
    const auto* whole = value.value.get_if<std::int64_t>();
    if (whole == nullptr) {
        return cursor.fail_at(first, what);
    }
    number = *whole;
    return true;
}

} // namespace busbar::controller::detail
