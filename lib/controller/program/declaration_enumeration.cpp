#include "constant_table.hpp"
#include "declaration_cursor.hpp"
#include "declaration_keywords.hpp"
#include "declaration_parser.hpp"
#include "literal.hpp"

namespace busbar::controller::detail {

bool DeclarationParser::read_enumerators(DerivedType& type, std::optional<ElementaryType> base)
{
    type.kind = DerivedType::Kind::Enumeration;
    cursor_->constants().begin_enumeration(type.name);
    bool is_read = true;
    do {
        is_read = read_enumerator(type, base);
    } while (is_read && cursor_->skip_symbol(","));
    cursor_->constants().end_enumeration();
    return is_read && (cursor_->skip_symbol(")") || cursor_->fail("',', ':=' or ')'"));
}

bool DeclarationParser::read_enumerator(DerivedType& type, std::optional<ElementaryType> base)
{
    Enumerator one;
    std::int64_t value =
        type.enumerators.empty() ? 0 : std::int64_t{type.enumerators.back().value} + 1;
    DeclarationToken at = cursor_->now();
    ConstantTable::Declared declared{.name = at.text, .text = {}, .place = cursor_->place()};
    if (!cursor_->keep(sizeof one + ConstantTable::memory_of_one) ||
        !cursor_->expect_name(one.name, "the name of a value")) {
        return false;
    }
    if (cursor_->skip_symbol(":=")) {
        at = cursor_->now();
        if (!read_whole_number(*cursor_, value, "a whole number")) {
            return false;
        }
        declared.text = cursor_->text_from(at.offset);
    }
    cursor_->constants().add_enumerator(declared);
    // Values are Int32, whatever type a vendor stores them in (W588, 6-2-2).
    const ElementaryType range = base.value_or(ElementaryType::Dint);
    if (!number_fits(range, Variant{value}) || value < INT32_MIN || value > INT32_MAX) {
        return cursor_->fail_with(at.offset, "found the value " + std::to_string(value) +
                                                 ", expected one that is both of the type " +
                                                 std::string{base ? "before it" : "DINT"} +
                                                 " and of 32 bits with a sign");
    }
    one.value = static_cast<std::int32_t>(value);
    type.enumerators.push_back(std::move(one));
    return true;
}

bool DeclarationParser::read_base(const DerivedType& type)
{
    if (cursor_->now().kind != DeclarationToken::Kind::Word) {
        return true;
    }
    const DeclarationToken word = cursor_->take();
    const auto base = elementary_type(word.text);
    if (!base || !is_integer(*base)) {
        return cursor_->fail_at(word, "';', ':=' or a type of whole numbers");
    }
    for (const Enumerator& one : type.enumerators) {
        if (!number_fits(*base, Variant{std::int64_t{one.value}})) {
            return cursor_->fail_at(word, "a type in which the value " + std::to_string(one.value) +
                                              " is");
        }
    }
    return true;
}

} // namespace busbar::controller::detail
