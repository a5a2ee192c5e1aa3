#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>

/// Labels: the variables of a PLC's program by their names, as seed 001 has them. A PLC whose
/// protocol names variables otherwise translates.
namespace busbar::backend {

/// What a label is declared as (seed 001, 8.2).
enum class LabelType : std::uint8_t {
    Bit,
    UnsignedWord,       // also a bit string of 16
    UnsignedDoubleWord, // also a bit string of 32
    Word,
    DoubleWord,
    Float,  // single precision
    Double, // double precision
    Time,
    String,        // ASCII and Shift-JIS
    UnicodeString, // UTF-16
    Timer,
    RetentiveTimer,
    LongTimer,
    LongRetentiveTimer,
    Counter,
    LongCounter,
    // What no value can be had of.
    Pointer,
    FunctionBlock,
    Structure,
};

/// What of a timer or counter is meant: S, C or N behind its name (seed 001, 8.3). None for all
/// other types.
enum class TimerPart : std::uint8_t { None, Contact, Coil, Current };

/// What a label's name stands for.
struct LabelKind {
    LabelType type{LabelType::Word};
    TimerPart part{TimerPart::None};
    /// Of String and UnicodeString: the characters that it is declared with, without the zero
    /// behind them. A character of a String is a byte, of a UnicodeString a unit of 16 bits.
    std::uint32_t length{0};

    friend bool operator==(const LabelKind&, const LabelKind&) = default;
};

[[nodiscard]] constexpr bool is_text(LabelType type)
{
    return type == LabelType::String || type == LabelType::UnicodeString;
}

/// How its value lies in memory: contact and coil as a Bit, the current value as an UnsignedWord
/// or, of long ones, an UnsignedDoubleWord; all else as itself.
[[nodiscard]] BUSBAR_API LabelType value_type(LabelType type, TimerPart part);

/// Bytes of a value, little endian: 1 of a Bit (0 or 1), 2 of words, 4 of double words, Float and
/// Time (milliseconds, signed), 8 of Double; of texts `length` characters and the zero behind them.
/// 0 for what has no value.
[[nodiscard]] BUSBAR_API std::size_t size_of(const LabelKind& kind);
/// Words of 16 bits that it takes in a PLC; a Bit counts as one. What limits count (seed 001, 2.1).
[[nodiscard]] BUSBAR_API std::size_t words_of(const LabelKind& kind);

} // namespace busbar::backend
