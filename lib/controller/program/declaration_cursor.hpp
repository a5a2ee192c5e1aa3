#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/controller/declaration_reader.hpp>

#include "declaration_lexer.hpp"
#include "text_places.hpp"

namespace busbar::controller::detail {

/// What a reader may still keep, in bytes.
class MemoryBudget {
public:
    explicit MemoryBudget(std::size_t bytes) : left_{bytes} {}

    /// False, and nothing is taken, if there is not that much left.
    [[nodiscard]] bool take(std::size_t bytes)
    {
        const bool is_there = bytes <= left_;
        left_ -= is_there ? bytes : 0;
        return is_there;
    }

private:
    std::size_t left_;
};

/// Bytes that a copy takes, about.
[[nodiscard]] std::size_t memory_of(const InitialValue& value);
[[nodiscard]] std::size_t memory_of(const TypeUse& use);

/// A text as tokens, with one of them in view, and the first problem that was found. After that
/// the token in view stays where it is.
class BUSBAR_API DeclarationCursor {
public:
    /// What is given must outlive it. Without `places` problems and places have no lines.
    DeclarationCursor(std::string_view text, std::string_view file_name, const TextPlaces* places,
                      const DeclarationLimits& limits, MemoryBudget& memory);

    [[nodiscard]] const DeclarationToken& now() const { return now_; }
    [[nodiscard]] bool is_end() const { return now_.kind == DeclarationToken::Kind::End; }
    [[nodiscard]] bool is_symbol(std::string_view symbol) const;
    /// In whatever case.
    [[nodiscard]] bool is_word(std::string_view word) const;
    [[nodiscard]] ProgramPlace place() const { return place_at(now_.offset); }
    [[nodiscard]] ProgramPlace place_at(std::size_t offset) const;
    /// Of what was taken last, if it begins in the same line.
    [[nodiscard]] std::string_view comment() const { return lexer_.comment(); }
    [[nodiscard]] const DeclarationLimits& limits() const { return *limits_; }

    DeclarationToken take();
    /// True if it was there.
    bool skip_symbol(std::string_view symbol);
    bool skip_word(std::string_view word);
    /// A problem if it is not there.
    [[nodiscard]] bool expect_symbol(std::string_view symbol);
    [[nodiscard]] bool expect_word(std::string_view word);
    /// A word that is no keyword; `what` is expected.
    [[nodiscard]] bool expect_name(std::string& name, std::string_view what);
    /// False and a problem if `bytes` more are too many.
    [[nodiscard]] bool keep(std::size_t bytes);

    /// Always false, so that it can be returned: "found 'x', expected `what`".
    bool fail(std::string_view what) { return fail_at(now_, what); }
    bool fail_at(const DeclarationToken& token, std::string_view what);
    bool fail_with(std::size_t offset, std::string text);
    /// There must be one.
    [[nodiscard]] const Problem& problem() const { return *problem_; }

private:
    DeclarationLexer lexer_;
    std::string_view file_name_;
    const TextPlaces* places_;
    const DeclarationLimits* limits_;
    MemoryBudget* memory_;
    DeclarationToken now_{};
    std::optional<Problem> problem_{};
};

/// "machine.st:12:5"; without line and column if these are not known.
[[nodiscard]] BUSBAR_API std::string place_text(std::string_view file_name,
                                                const ProgramPlace& place);

} // namespace busbar::controller::detail
