#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

namespace busbar::controller::detail {

/// What a word of IEC 61131-3 is to a reader of declarations; names are all others.
enum class WordKind : std::uint8_t {
    Name,
    Keyword,
    ElementaryType,
    /// The name of a type that a program cannot have here.
    UnknownType,
};

/// In whatever case. Words that mean something in one place only, as ON and TASK, are names.
[[nodiscard]] WordKind kind_of_word(std::string_view word);

/// The type of this name, or of this prefix of a literal.
[[nodiscard]] BUSBAR_API std::optional<ElementaryType> elementary_type(std::string_view word);

/// Types of whole numbers that have subranges and can be the base of an enumeration.
[[nodiscard]] BUSBAR_API bool is_integer(ElementaryType type);
/// BYTE to LWORD.
[[nodiscard]] bool is_bit_string(ElementaryType type);
/// Whether `value`, an Int64, UInt64 or Double, is in the range of the numeric type.
[[nodiscard]] BUSBAR_API bool number_fits(ElementaryType type, const Variant& value);

/// "%IX0.0", "%MW10", "%Q*": a place, a size and numbers between points (IEC 61131-3, 6.5.5.1);
/// "%D100", "%U0\\G1": a device as SH-082679 names it (8.3, Collectible devices).
[[nodiscard]] BUSBAR_API bool is_direct_address(std::string_view text);

} // namespace busbar::controller::detail
