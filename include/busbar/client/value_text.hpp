#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/core/expected.hpp>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/api.hpp>

/// Values as text for people, and back.
namespace busbar::client {

/// The names that values have as text.
struct TextOptions {
    /// Structures with one of these encodings are printed with their fields.
    const binary::DynamicTypes* types{nullptr};
    /// The DataType of the value if it is known, so that enumerations have names.
    const binary::DynamicType* type{nullptr};
    binary::TextLimits limits;
};

/// Prints as binary::to_text, with the structures and names that are known. Safe to print on a
/// terminal.
[[nodiscard]] BUSBAR_API std::string to_text(const Variant& value, const TextOptions& options = {});
/// Returns "21.5", and with status and time if they are meaningful: "21.5
/// (Uncertain_LastUsableValue, 2026-11-21T06:00:00Z)".
[[nodiscard]] BUSBAR_API std::string to_text(const DataValue& value,
                                             const TextOptions& options = {});

/// Says how a text is read: the attributes DataType and ValueRank of a Variable.
struct ValueType {
    /// Variant means any type. The text names it, "Int16:5", or it follows from the text's form.
    BuiltInType built_in{BuiltInType::Variant};
    /// Part 3, 5.6.2: -1 a scalar, 1 an array, more a matrix, 0 an array or matrix, -2 anything,
    /// -3 a scalar or array.
    std::int32_t value_rank{-1};
    /// The names of an enumeration, or the fields of a structure; null for a built-in type.
    const binary::DynamicType* type{nullptr};
    /// Needed for structures that name their type, in the form of to_json, and for `base`.
    const binary::DynamicTypes* types{nullptr};
    /// A structure of this type, whose fields are used if the text does not name them; without it,
    /// a text that leaves out a field that is not optional is refused.
    const Variant* base{nullptr};
};

/// The reason why a text cannot be read as a value of a type.
struct ValueError {
    /// "expected a Byte, 0 to 255, found 300"; printable.
    std::string message;
};

/// Reads a value.
///
/// A scalar is the text itself: 42, true, NaN, any text for a String, 2026-11-21T06:00:00Z, base64
/// or 0x00FF for a ByteString, ns=2;s=Pump, 2:Name, Bad_Timeout, and names or numbers for
/// enumerations (A|B for an option set). Types of IEC 61131-3 have its literals, T#1s500ms,
/// TOD#06:00:00, D#2026-11-21 and DT#2026-11-21-06:00:00. Arrays are JSON lists, [1, 2], and
/// matrices lists of lists; texts within are in quotes. Objects stand for a LocalizedText,
/// {"Locale": "en", "Text": "x"}, and for structures by their fields' names. What to_json writes
/// with types can be read as a Variant.
[[nodiscard]] BUSBAR_API Expected<Variant, ValueError> parse_value(std::string_view text,
                                                                   const ValueType& type);

} // namespace busbar::client
