#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// A piece of a text of declarations.
struct DeclarationToken {
    enum class Kind : std::uint8_t {
        End,
        /// A word: a name, a keyword, a type.
        Word,
        /// "1_000", "16#FF", "1.5e-3"; without a sign.
        Number,
        /// "T#1h2m", "INT#-5", "Mode#On".
        Typed,
        /// With its quotes.
        Text,
        /// "%IX0.0".
        Address,
        /// Without its braces.
        Pragma,
        /// ":=", "..", or any one character.
        Symbol,
        /// A comment, text or pragma without an end; `text` is what to say of it.
        Wrong,
    };

    Kind kind{Kind::End};
    std::string_view text{};
    /// Where it begins.
    std::size_t offset{0};
};

/// Cuts a text, which is UTF-8, into tokens. Each byte is looked at a few times at most.
class DeclarationLexer {
public:
    /// `text` must outlive it and its tokens.
    explicit DeclarationLexer(std::string_view text) : text_{text} {}

    /// After the last one it is End for ever.
    [[nodiscard]] DeclarationToken next();
    /// What the first comment between the last token and the one before says, if it begins in the
    /// line in which that one ends; empty if there is none.
    [[nodiscard]] std::string_view comment() const { return comment_; }

private:
    /// False if there is a comment without an end.
    [[nodiscard]] bool skip_blanks(DeclarationToken& wrong);
    [[nodiscard]] bool skip_comment(DeclarationToken& wrong);
    /// From here on; the end of a comment of this kind, or npos.
    [[nodiscard]] std::size_t block_end(std::string_view open, std::string_view close) const;
    void keep_comment(std::string_view text);
    [[nodiscard]] DeclarationToken word();
    [[nodiscard]] DeclarationToken number();
    [[nodiscard]] DeclarationToken quoted();
    [[nodiscard]] DeclarationToken address();
    [[nodiscard]] DeclarationToken pragma();
    [[nodiscard]] DeclarationToken symbol();
    /// The end of the text that has its first quote at `at`, or npos.
    [[nodiscard]] std::size_t quoted_end(std::size_t at) const;
    /// The end of what is behind a `#`.
    [[nodiscard]] std::size_t typed_end(std::size_t at) const;
    [[nodiscard]] std::size_t skip_while(std::size_t at, bool (*belongs)(char)) const;
    /// 0 behind the end.
    [[nodiscard]] char at(std::size_t index) const;
    [[nodiscard]] DeclarationToken take(DeclarationToken::Kind kind, std::size_t end);

    std::string_view text_;
    std::size_t at_{0};
    std::string_view comment_{};
    bool is_same_line_{false};
    bool has_comment_{false};
};

/// Without blanks at its ends.
[[nodiscard]] BUSBAR_API std::string_view trimmed_text(std::string_view text);

} // namespace busbar::controller::detail
