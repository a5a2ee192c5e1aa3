#include "declaration_cursor.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"
#include "declaration_keywords.hpp"
#include "literal.hpp"

namespace busbar::controller::detail {

std::size_t memory_of(const InitialValue& value)
{
    std::size_t sum = sizeof value + value.member.size() + value.enumeration.size();
    if (const auto* text = value.value.get_if<String>()) {
        sum += text->size();
    }
    for (const InitialValue& part : value.parts) {
        sum += memory_of(part);
    }
    return sum;
}

std::size_t memory_of(const TypeUse& use)
{
    return sizeof use + use.type_name.size() + use.dimensions.size() * sizeof(Bounds);
}

std::string place_text(std::string_view file_name, const ProgramPlace& place)
{
    std::string text{printable(file_name)};
    if (place.line != 0) {
        text += ':' + std::to_string(place.line) + ':' + std::to_string(place.column);
    }
    return text;
}

DeclarationCursor::DeclarationCursor(std::string_view text, std::string_view file_name,
                                     const TextPlaces* places, const DeclarationLimits& limits,
                                     MemoryBudget& memory, ConstantTable& constants,
                                     std::size_t begin)
    : text_{text}, lexer_{text, begin}, file_name_{file_name}, places_{places}, limits_{&limits},
      memory_{&memory}, constants_{&constants}
{
    now_ = lexer_.next();
}

bool DeclarationCursor::is_symbol(std::string_view symbol) const
{
    return now_.kind == DeclarationToken::Kind::Symbol && now_.text == symbol;
}

bool DeclarationCursor::is_word(std::string_view word) const
{
    return now_.kind == DeclarationToken::Kind::Word &&
           busbar::detail::is_same_ignoring_case(now_.text, word);
}

ProgramPlace DeclarationCursor::place_at(std::size_t offset) const
{
    return places_ != nullptr ? places_->at(offset) : ProgramPlace{};
}

DeclarationToken DeclarationCursor::take()
{
    const DeclarationToken taken = now_;
    if (!problem_ && now_.kind != DeclarationToken::Kind::Wrong) {
        now_ = lexer_.next();
    }
    return taken;
}

bool DeclarationCursor::skip_symbol(std::string_view symbol)
{
    const bool is_there = is_symbol(symbol);
    if (is_there) {
        take();
    }
    return is_there;
}

bool DeclarationCursor::skip_word(std::string_view word)
{
    const bool is_there = is_word(word);
    if (is_there) {
        take();
    }
    return is_there;
}

void DeclarationCursor::skip_line()
{
    if (!problem_) {
        const std::size_t end = std::min(text_.find('\n', now_.offset), text_.size());
        lexer_ = DeclarationLexer{text_, end};
        now_ = lexer_.next();
    }
}

bool DeclarationCursor::expect_symbol(std::string_view symbol)
{
    return skip_symbol(symbol) || fail("'" + std::string{symbol} + "'");
}

bool DeclarationCursor::expect_word(std::string_view word)
{
    return skip_word(word) || fail("'" + std::string{word} + "'");
}

bool DeclarationCursor::expect_name(std::string& name, std::string_view what)
{
    std::string_view text = now_.text;
    if (is_quoted_name()) {
        text = text.substr(1, text.size() - 2);
    } else if (now_.kind != DeclarationToken::Kind::Word ||
               kind_of_word(text) == WordKind::Keyword ||
               kind_of_word(text) == WordKind::ElementaryType) {
        return fail(what);
    }
    if (text.size() > limits_->max_name_length) {
        return fail("a name of at most " + std::to_string(limits_->max_name_length) + " bytes");
    }
    name = text;
    take();
    return keep(name.size());
}

bool DeclarationCursor::is_quoted_name() const
{
    return now_.kind == DeclarationToken::Kind::Text && now_.text.starts_with('"') &&
           now_.text.size() > 2 && now_.text.find('$') == now_.text.npos;
}

bool DeclarationCursor::keep(std::size_t bytes)
{
    if (memory_->take(bytes)) {
        return true;
    }
    is_exhausted_ = true;
    return fail_with(now_.offset, "takes more than " + std::to_string(limits_->max_memory) +
                                      " bytes of memory up to here");
}

bool DeclarationCursor::fail_at(const DeclarationToken& token, std::string_view what)
{
    if (token.kind == DeclarationToken::Kind::Wrong) {
        return fail_with(token.offset, std::string{token.text});
    }
    if (token.kind == DeclarationToken::Kind::End) {
        return fail_with(token.offset, "found the end of the text, expected " + std::string{what});
    }
    if (token.kind == DeclarationToken::Kind::Pragma) {
        return fail_with(token.offset, "found a pragma, expected " + std::string{what});
    }
    return fail_with(token.offset, found_expected(token.text, what));
}

bool DeclarationCursor::fail_with(std::size_t offset, std::string text)
{
    if (!problem_) {
        problem_place_ = place_at(offset);
        problem_.emplace();
        problem_->where = place_text(file_name_, problem_place_);
        problem_->text = std::move(text);
    }
    return false;
}

std::pair<std::string, ProgramPlace> DeclarationCursor::recover()
{
    std::pair<std::string, ProgramPlace> told{std::move(problem_->text), problem_place_};
    problem_.reset();
    pass_wrong();
    return told;
}

void DeclarationCursor::pass_wrong()
{
    while (now_.kind == DeclarationToken::Kind::Wrong) {
        lexer_.resume(now_);
        now_ = lexer_.next();
    }
}

} // namespace busbar::controller::detail
