#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <busbar/controller/program.hpp>

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
[[nodiscard]] std::optional<ElementaryType> elementary_type(std::string_view word);

/// Types of whole numbers that have subranges and can be the base of an enumeration.
[[nodiscard]] bool is_integer(ElementaryType type);
/// BYTE to LWORD.
[[nodiscard]] bool is_bit_string(ElementaryType type);
/// Whether `value`, an Int64, UInt64 or Double, is in the range of the numeric type.
[[nodiscard]] bool number_fits(ElementaryType type, const Variant& value);

} // namespace busbar::controller::detail
