#include "declaration_cursor.hpp"
#include "declaration_keywords.hpp"
#include "declaration_parser.hpp"

namespace busbar::controller::detail {

bool read_type_use(DeclarationCursor& cursor, ReadingPass& pass, TypeUse& use)
{
    return DeclarationParser{cursor, pass}.read_type_use(use);
}

bool DeclarationParser::read_use(TypeUse& use, DerivedType* declared)
{
    // Automation Studio of B&R writes pragmas also before the type.
    while (cursor_->now().kind == DeclarationToken::Kind::Pragma) {
        cursor_->take();
    }
    while (cursor_->skip_word("ARRAY")) {
        if (!read_bounds(use) || !cursor_->expect_word("OF")) {
            return false;
        }
    }
    if (is_at_nameless()) {
        return read_nameless(use);
    }
    if (cursor_->is_quoted_name()) {
        return read_qualified(use);
    }
    if (cursor_->now().kind != DeclarationToken::Kind::Word) {
        return cursor_->fail("a type");
    }
    switch (kind_of_word(cursor_->now().text)) {
    case WordKind::ElementaryType:
    case WordKind::LaterType:
        return read_elementary(use, declared);
    case WordKind::Name:
        return read_qualified(use);
    case WordKind::UnknownType:
        if (leaves_out_) {
            return cursor_->fail_with(cursor_->now().offset, "is of the type " +
                                                                 std::string{cursor_->now().text} +
                                                                 ", which is not served");
        }
        [[fallthrough]];
    default:
        return cursor_->fail("a type that is known here");
    }
}

bool DeclarationParser::read_bounds(TypeUse& use)
{
    if (!cursor_->expect_symbol("[")) {
        return false;
    }
    do {
        const std::size_t most = cursor_->limits().max_dimensions;
        if (use.dimensions.size() == most) {
            return cursor_->fail_with(cursor_->now().offset,
                                      "has more than " + std::to_string(most) + " dimensions");
        }
        Bounds bounds;
        if (!read_range(bounds)) {
            return false;
        }
        use.dimensions.push_back(bounds);
    } while (cursor_->skip_symbol(","));
    return cursor_->skip_symbol("]") || cursor_->fail("',' or ']'");
}

bool DeclarationParser::read_range(Bounds& bounds)
{
    const DeclarationToken at = cursor_->now();
    if (!read_whole_number(*cursor_, bounds.lower, "a whole number") ||
        !cursor_->expect_symbol("..") ||
        !read_whole_number(*cursor_, bounds.upper, "a whole number")) {
        return false;
    }
    return bounds.lower <= bounds.upper ||
           cursor_->fail_with(at.offset, "found the bounds " + std::to_string(bounds.lower) + ".." +
                                             std::to_string(bounds.upper) +
                                             ", expected the lower one first");
}

bool DeclarationParser::read_elementary(TypeUse& use, DerivedType* declared)
{
    use.elementary = *elementary_type(cursor_->take().text);
    if (use.elementary == ElementaryType::String || use.elementary == ElementaryType::Wstring) {
        return read_length(use);
    }
    if (!is_integer(use.elementary) || !cursor_->skip_symbol("(")) {
        return true;
    }
    if (declared != nullptr && use.dimensions.empty() &&
        cursor_->now().kind == DeclarationToken::Kind::Word) {
        return read_enumerators(*declared, use.elementary);
    }
    Bounds bounds;
    if (!read_range(bounds) || !cursor_->expect_symbol(")")) {
        return false;
    }
    use.subrange = bounds;
    return true;
}

bool DeclarationParser::read_length(TypeUse& use)
{
    const bool is_square = cursor_->is_symbol("[");
    if (!is_square && !cursor_->is_symbol("(")) {
        return true;
    }
    cursor_->take();
    const DeclarationToken at = cursor_->now();
    std::int64_t length = 0;
    if (!read_whole_number(*cursor_, length, "a length")) {
        return false;
    }
    // The length plus the terminating zero must fit 32 bits.
    if (length < 1 || length >= UINT32_MAX) {
        return cursor_->fail_at(at, "a length from 1 on");
    }
    use.string_length = static_cast<std::uint32_t>(length);
    return cursor_->expect_symbol(is_square ? "]" : ")");
}

} // namespace busbar::controller::detail
