#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/controller/declaration_reader.hpp>

#include "declaration_lexer.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

class ConstantTable;

/// The number of bytes that a reader may still use for its result.
class MemoryBudget {
public:
    explicit MemoryBudget(std::size_t bytes) : left_{bytes} {}

    /// Takes bytes from the budget. False, with nothing taken, if there are too few.
    [[nodiscard]] bool take(std::size_t bytes)
    {
        const bool is_there = bytes <= left_;
        left_ -= is_there ? bytes : 0;
        return is_there;
    }

private:
    std::size_t left_;
};

/// Estimates the memory that a copy takes, in bytes.
[[nodiscard]] std::size_t memory_of(const InitialValue& value);
[[nodiscard]] std::size_t memory_of(const TypeUse& use);

/// Shows a text token by token and keeps the first problem. After a problem the current token no
/// longer changes.
class BUSBAR_API DeclarationCursor {
public:
    /// All arguments must outlive this object. Without `places`, problems and places have no lines.
    /// Names in expressions are looked up in `constants`. The first token is at `begin` or after
    /// it.
    DeclarationCursor(std::string_view text, std::string_view file_name, const TextPlaces* places,
                      const DeclarationLimits& limits, MemoryBudget& memory,
                      ConstantTable& constants, std::size_t begin = 0);

    [[nodiscard]] const DeclarationToken& now() const { return now_; }
    [[nodiscard]] bool is_end() const { return now_.kind == DeclarationToken::Kind::End; }
    [[nodiscard]] bool is_symbol(std::string_view symbol) const;
    /// True if the current token is this word, regardless of case.
    [[nodiscard]] bool is_word(std::string_view word) const;
    [[nodiscard]] ProgramPlace place() const { return place_at(now_.offset); }
    [[nodiscard]] ProgramPlace place_at(std::size_t offset) const;
    /// The comment on the last taken token, if it begins in the same line.
    [[nodiscard]] std::string_view comment() const { return lexer_.comment(); }
    [[nodiscard]] const DeclarationLimits& limits() const { return *limits_; }
    [[nodiscard]] MemoryBudget& memory() const { return *memory_; }
    [[nodiscard]] ConstantTable& constants() const { return *constants_; }
    /// The text from the current token on.
    [[nodiscard]] std::string_view rest() const { return text_.substr(now_.offset); }
    /// The text from `offset` up to the current token.
    [[nodiscard]] std::string_view text_from(std::size_t offset) const
    {
        return text_.substr(offset, now_.offset - offset);
    }

    DeclarationToken take();
    /// Takes the current token if it is this symbol; false if it is another.
    bool skip_symbol(std::string_view symbol);
    bool skip_word(std::string_view word);
    /// Skips the current token and what follows it in its line, whatever that is.
    void skip_line();
    /// Takes this symbol; otherwise reports a problem.
    [[nodiscard]] bool expect_symbol(std::string_view symbol);
    [[nodiscard]] bool expect_word(std::string_view word);
    /// Takes a word that is not a keyword, or a name in double quotes as TIA Portal writes it;
    /// otherwise reports that `what` was expected.
    [[nodiscard]] bool expect_name(std::string& name, std::string_view what);
    [[nodiscard]] bool is_quoted_name() const;
    /// Takes `bytes` from the budget; reports a problem, and gives false, if it is exhausted.
    [[nodiscard]] bool keep(std::size_t bytes);

    /// Reports "found 'x', expected `what`". Always returns false, so that callers can return the
    /// result.
    bool fail(std::string_view what) { return fail_at(now_, what); }
    bool fail_at(const DeclarationToken& token, std::string_view what);
    bool fail_with(std::size_t offset, std::string text);
    /// Returns the problem; call this only if there is one.
    [[nodiscard]] const Problem& problem() const { return *problem_; }
    /// True if there is a problem after which reading can continue: any but exhausted memory.
    [[nodiscard]] bool can_recover() const { return problem_ && !is_exhausted_; }
    /// Forgets the problem, and passes a token that is wrong. Returns the text and the place of the
    /// problem.
    std::pair<std::string, ProgramPlace> recover();
    /// Skips tokens that are wrong.
    void pass_wrong();

private:
    std::string_view text_;
    DeclarationLexer lexer_;
    std::string_view file_name_;
    const TextPlaces* places_;
    const DeclarationLimits* limits_;
    MemoryBudget* memory_;
    ConstantTable* constants_;
    DeclarationToken now_{};
    std::optional<Problem> problem_{};
    ProgramPlace problem_place_{};
    bool is_exhausted_{false};
};

/// Writes a place: "machine.st:12:5", or the file name alone if line and column are unknown.
[[nodiscard]] BUSBAR_API std::string place_text(std::string_view file_name,
                                                const ProgramPlace& place);

/// Reads the value after `:=`: an expression, an aggregate `(X := 1)` or a list `[1, 2(0)]`. The
/// member and the repetition of `value` are already set. Gives false after reporting a problem at
/// the cursor.
[[nodiscard]] BUSBAR_API bool read_initial_value(DeclarationCursor& cursor, InitialValue& value,
                                                 std::size_t depth = 0);

/// Reads an expression whose value is an integer; otherwise reports that `what` was expected.
/// Leaves `number` alone if the value is not known yet.
[[nodiscard]] BUSBAR_API bool read_whole_number(DeclarationCursor& cursor, std::int64_t& number,
                                                std::string_view what);

} // namespace busbar::controller::detail
