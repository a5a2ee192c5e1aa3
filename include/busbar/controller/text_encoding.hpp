#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// The encodings of text files that users have: declarations, PLCopen XML and tables, as
/// development systems and spreadsheets of many countries save them.
namespace busbar::controller {

/// The encoding of a text file.
enum class TextEncoding : std::uint8_t {
    Utf8,
    Recognized, // to be recognized by the content
    Utf16Little,
    Utf16Big,
    ShiftJis,    // CP932, as Windows has it
    Windows1252, // with it ISO 8859-1
};

/// Returns "UTF-8", "UTF-16LE", "UTF-16BE", "Shift-JIS" or "Windows-1252", and "" for Recognized.
[[nodiscard]] BUSBAR_API std::string_view name(TextEncoding encoding);

/// Finds an encoding by one of its usual names, regardless of case, such as "utf-8", "UTF-16",
/// "cp932", "latin-1" or "iso-8859-1". "utf-16" alone is little endian.
[[nodiscard]] BUSBAR_API std::optional<TextEncoding> find_text_encoding(std::string_view name);

/// A text in UTF-8, without a byte order mark. Refers to the bytes that it was decoded from if they
/// were UTF-8 already.
class DecodedText {
public:
    DecodedText(std::string_view given, TextEncoding encoding) : given_{given}, encoding_{encoding}
    {
    }
    DecodedText(std::string text, TextEncoding encoding)
        : own_{std::move(text)}, encoding_{encoding}
    {
    }

    /// The text, valid as long as the object and the bytes.
    [[nodiscard]] std::string_view text() const { return own_ ? *own_ : given_; }
    /// The encoding that it was decoded from.
    [[nodiscard]] TextEncoding encoding() const { return encoding_; }

private:
    std::string_view given_{};
    std::optional<std::string> own_{};
    TextEncoding encoding_;
};

/// Decodes a text file. `bytes` must outlive the result.
///
/// The encoding is that of a byte order mark; otherwise `asked`; if that is Recognized, in this
/// order:
///
/// 1. UTF-16, if the first character is ASCII and has a zero beside it.
/// 2. UTF-8, if all of it is.
/// 3. The encoding that an XML declaration names.
/// 4. UTF-8 with mistakes, if more characters are UTF-8 than are not.
/// 5. Shift-JIS, if all of it is, and Japanese text of everyday characters prevails: those of the
///    lead bytes 81 to 9F (hexadecimal) and katakana of half width over those from E0 on, which are
///    also accented letters of Western languages.
/// 6. Windows-1252.
///
/// A byte or unit that the encoding does not have, such as half of a surrogate pair or a sequence
/// that is cut off, is a Problem with its line and column: "machine.st:12:5". So is a text of more
/// than `max_size` bytes, as given or as UTF-8. Takes time in proportion to the text.
[[nodiscard]] BUSBAR_API Configured<DecodedText>
decode_text(std::string_view bytes, std::string_view file_name, std::size_t max_size,
            TextEncoding asked = TextEncoding::Recognized);

} // namespace busbar::controller
