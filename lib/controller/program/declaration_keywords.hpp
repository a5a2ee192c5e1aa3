#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// The meaning of a word of IEC 61131-3 to a reader of declarations; every other word is a name.
enum class WordKind : std::uint8_t {
    Name,
    Keyword,
    ElementaryType,
    /// The same, but of the 3rd edition or of vendors: programs also use the word as a name.
    LaterType,
    /// The name of a type that programs cannot use here.
    UnknownType,
};

/// Classifies a word regardless of case. Words with a meaning in one place only, such as ON and
/// TASK, are names.
[[nodiscard]] WordKind kind_of_word(std::string_view word);

/// Finds the type with this name, which may also be the prefix of a literal.
[[nodiscard]] BUSBAR_API std::optional<ElementaryType> elementary_type(std::string_view word);

/// True for integer types, which can have subranges and be the base of an enumeration.
[[nodiscard]] BUSBAR_API bool is_integer(ElementaryType type);
/// True for BYTE to LWORD.
[[nodiscard]] bool is_bit_string(ElementaryType type);
/// Tells whether `value`, an Int64, UInt64 or Double, is in the range of the numeric type.
[[nodiscard]] BUSBAR_API bool number_fits(ElementaryType type, const Variant& value);

/// Tells whether the text is an address: "%IX0.0", "%MW10", "%Q*" have a place, a size and numbers
/// between points (IEC 61131-3, 6.5.5.1); "%D100", "%U0\\G1" name a device as in SH-082679 (8.3,
/// Collectible devices).
[[nodiscard]] BUSBAR_API bool is_direct_address(std::string_view text);

/// The publish attribute in a pragma.
struct PublishPragma {
    /// False for a pragma about something else, which is ignored.
    bool is_publish{false};
    /// Empty if the attribute is not a known one.
    std::optional<NetworkPublish> publish{};
};

/// Parses the text of a pragma without braces, as declaration_lexer.hpp provides it.
[[nodiscard]] PublishPragma read_publish_pragma(std::string_view text);

/// Parses "publish only", with blanks, hyphens, underscores or nothing between words, regardless of
/// case.
[[nodiscard]] BUSBAR_API std::optional<NetworkPublish> publish_of(std::string_view words);

} // namespace busbar::controller::detail
