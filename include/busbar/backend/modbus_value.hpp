#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <busbar/core/api.hpp>
#include <busbar/core/built_in_type.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/variant.hpp>

/// Values in the registers of a Modbus device. The protocol has words of 16 bits only; types and
/// the order of words are conventions of each device and have to be configured.
namespace busbar::backend {

/// The representation of a value in a device.
enum class ModbusType : std::uint8_t {
    /// A coil, a discrete input, or a bit of a register.
    Bool,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float,
    Double,
    /// Four decimal digits in each register: 1 register is a UInt16, 2 a UInt32, 4 a UInt64.
    Bcd16,
    Bcd32,
    Bcd64,
    /// Two bytes of UTF-8 in each register, filled up with zeros.
    Text,
};

/// The order of the bytes of a value of 32 bits, from A, the highest, to D, as the device sends
/// them. For 64 bits the words are in the same or in the reversed order; for 16 bits and texts only
/// the bytes of a word can be swapped.
enum class ModbusOrder : std::uint8_t {
    ABCD, // highest word first: what most devices call big-endian
    CDAB, // lowest word first
    BADC, // highest word first, its bytes swapped
    DCBA, // lowest word first, its bytes swapped
};

/// The type of a value, with what is needed to find it in its registers.
struct ModbusValueType {
    /// The type.
    ModbusType type{ModbusType::UInt16};
    /// The order of its words and bytes.
    ModbusOrder order{ModbusOrder::ABCD};
    /// Text: the number of bytes, 1 to 250. Otherwise 0.
    std::uint8_t length{0};

    friend bool operator==(const ModbusValueType&, const ModbusValueType&) = default;
};

/// The number of registers of a value; 1 for a Bool.
[[nodiscard]] BUSBAR_API std::size_t registers_of(const ModbusValueType& type);
/// The data type of a value.
[[nodiscard]] BUSBAR_API BuiltInType data_type_of(ModbusType type);

/// Reads a value from its registers. A Bool is any register but 0. Bad_DecodingError if a BCD digit
/// is more than 9, a text is not UTF-8, or the number of `registers` is not registers_of(). A text
/// ends before its first zero.
[[nodiscard]] BUSBAR_API Result<Variant> read_modbus(const ModbusValueType& type,
                                                     std::span<const std::uint16_t> registers);
/// Writes a value, whose data type must be data_type_of(), to its registers. Bad_TypeMismatch
/// if it is not; Bad_OutOfRange for too many digits or bytes, and for a text with a zero in it,
/// which would not be read as it was written. A null String is an empty one. `registers` is then
/// unchanged.
[[nodiscard]] BUSBAR_API StatusCode write_modbus(const ModbusValueType& type, const Variant& value,
                                                 std::span<std::uint16_t> registers);

} // namespace busbar::backend
