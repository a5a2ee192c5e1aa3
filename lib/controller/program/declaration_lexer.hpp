#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// A token of a text of declarations.
struct DeclarationToken {
    enum class Kind : std::uint8_t {
        End,
        /// A name, a keyword or a type.
        Word,
        /// "1_000", "16#FF", "1.5e-3"; without a sign.
        Number,
        /// "T#1h2m", "INT#-5", "Mode#On".
        Typed,
        /// A text with its quotes.
        Text,
        /// "%IX0.0".
        Address,
        /// A pragma without its braces.
        Pragma,
        /// ":=", "..", or any single character.
        Symbol,
        /// A comment, text or pragma without an end; `text` is the message about it.
        Wrong,
    };

    Kind kind{Kind::End};
    std::string_view text{};
    /// Offset of the first byte in the text.
    std::size_t offset{0};
};

/// Splits a UTF-8 text into tokens. Looks at each byte a few times at most.
class DeclarationLexer {
public:
    /// `text` must outlive this object and its tokens; the first token is at `begin` or after it.
    explicit DeclarationLexer(std::string_view text, std::size_t begin = 0)
        : text_{text}, at_{begin}
    {
    }

    /// Returns the next token; End for ever after the last one.
    [[nodiscard]] DeclarationToken next();
    /// Continues after a Wrong token: a text ends with its line, anything else with the whole text.
    void resume(const DeclarationToken& wrong);
    /// The first comment between the last two tokens, if it begins in the line in which the first
    /// of them ends; empty otherwise.
    [[nodiscard]] std::string_view comment() const { return comment_; }

private:
    /// Skips blanks and comments; false if a comment has no end.
    [[nodiscard]] bool skip_blanks(DeclarationToken& wrong);
    [[nodiscard]] bool skip_comment(DeclarationToken& wrong);
    /// Finds the end of a comment that begins here; npos if there is none.
    [[nodiscard]] std::size_t block_end(std::string_view open, std::string_view close) const;
    void keep_comment(std::string_view text);
    [[nodiscard]] DeclarationToken word();
    [[nodiscard]] DeclarationToken number();
    [[nodiscard]] DeclarationToken quoted();
    [[nodiscard]] DeclarationToken address();
    [[nodiscard]] DeclarationToken pragma();
    /// Finds the brace that ends the pragma here, which is in no text; npos if there is none.
    [[nodiscard]] std::size_t pragma_end() const;
    [[nodiscard]] DeclarationToken symbol();
    /// Finds the end of the text whose first quote is at `at`; npos if there is none.
    [[nodiscard]] std::size_t quoted_end(std::size_t at) const;
    /// Finds the end of the value that follows a `#`. In a date, hyphens belong to it.
    [[nodiscard]] std::size_t typed_end(std::size_t at, bool is_date) const;
    [[nodiscard]] std::size_t skip_while(std::size_t at, bool (*belongs)(char)) const;
    /// Returns a character; 0 after the end.
    [[nodiscard]] char at(std::size_t index) const;
    [[nodiscard]] DeclarationToken take(DeclarationToken::Kind kind, std::size_t end);

    std::string_view text_;
    std::size_t at_;
    std::string_view comment_{};
    bool is_same_line_{false};
    bool has_comment_{false};
};

/// Removes blanks at both ends.
[[nodiscard]] BUSBAR_API std::string_view trimmed_text(std::string_view text);

} // namespace busbar::controller::detail
