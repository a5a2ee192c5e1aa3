#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/core/api.hpp>

/// Labels: the variables of a PLC's program by their names, as in the manual of model mode. A PLC
/// whose protocol names variables differently translates.
namespace busbar::backend {

/// The declared type of a label (SH-082679, 8.2).
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
    // Types without values.
    Pointer,
    FunctionBlock,
    Structure,
};

/// The part of a timer or counter that is selected by S, C or N after its name (manual of model
/// mode, 8.3). None for all other types.
enum class TimerPart : std::uint8_t { None, Contact, Coil, Current };

/// The kind of variable that a label's name refers to.
struct LabelKind {
    LabelType type{LabelType::Word};
    TimerPart part{TimerPart::None};
    /// For String and UnicodeString: the declared number of characters, without the terminating
    /// zero. A character of a String is a byte, of a UnicodeString a unit of 16 bits.
    std::uint32_t length{0};

    friend bool operator==(const LabelKind&, const LabelKind&) = default;
};

/// True for strings of either character set.
[[nodiscard]] constexpr bool is_text(LabelType type)
{
    return type == LabelType::String || type == LabelType::UnicodeString;
}

/// Returns the type of its value in memory: contact and coil are a Bit, the current value is an
/// UnsignedWord or, for long ones, an UnsignedDoubleWord; others do not change.
[[nodiscard]] BUSBAR_API LabelType value_type(LabelType type, TimerPart part);

/// Returns the bytes of a value, little endian: 1 for a Bit (0 or 1), 2 for words, 4 for double
/// words, Float and Time (milliseconds, signed), 8 for Double; for texts `length` characters and
/// the terminating zero. 0 for types without values.
[[nodiscard]] BUSBAR_API std::size_t size_of(const LabelKind& kind);
/// Returns the words of 16 bits that it takes in a PLC; a Bit counts as one. The unit of the limits
/// (SH-082679, 2.1).
[[nodiscard]] BUSBAR_API std::size_t words_of(const LabelKind& kind);

} // namespace busbar::backend
