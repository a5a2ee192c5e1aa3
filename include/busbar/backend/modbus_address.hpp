#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <busbar/backend/modbus_value.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::backend {

/// The four tables of a Modbus device (MODBUS Application Protocol V1.1b3, 4.3).
enum class ModbusTable : std::uint8_t { Coil, DiscreteInput, InputRegister, HoldingRegister };

/// True for the tables of bits.
[[nodiscard]] constexpr bool has_bits(ModbusTable table)
{
    return table == ModbusTable::Coil || table == ModbusTable::DiscreteInput;
}
/// True for the tables that can be written.
[[nodiscard]] constexpr bool is_writable(ModbusTable table)
{
    return table == ModbusTable::Coil || table == ModbusTable::HoldingRegister;
}

/// The place and type of a value in a device.
struct ModbusAddress {
    /// The table that it is in.
    ModbusTable table{ModbusTable::HoldingRegister};
    /// The first coil, input or register as on the wire, from 0.
    std::uint16_t offset{0};
    /// The bit of a register, 0 (lowest) to 15, for a Bool in a table of registers.
    std::optional<std::uint8_t> bit{};
    /// The type of its value.
    ModbusValueType value{};
    /// The unit behind a gateway; none: that of the connection.
    std::optional<std::uint8_t> unit{};

    friend bool operator==(const ModbusAddress&, const ModbusAddress&) = default;
};

/// Reads an address as engineers write it, case aside:
///
///     [unit/] place [.bit] [:type] [:order]
///
/// place is one of two, which cannot be taken for each other:
/// - `holding:0`, `input:0` (registers), `coil:0`, `discrete:0`: a table and the offset from 0, as
///   on the wire, 0 to 65535;
/// - `40001`, `400001`: a number of five or six digits whose first one is the table (0 coil,
///   1 discrete input, 3 input register, 4 holding register) and whose others count from 1. Both
///   are `holding:0`, and so on up to `49999` and `465536`.
///
/// type is `bool`, `int16`, `uint16` (the default of registers), `int32`, `uint32`, `int64`,
/// `uint64`, `float`, `double`, `bcd16`, `bcd32`, `bcd64` or `text20`, a text of 20 bytes. order
/// is `ABCD` (the default), `CDAB`, `BADC` or `DCBA` for types of 32 and 64 bits, `AB` or `BA` for
/// 16 bits and texts.
///
/// `holding:10.3` is bit 3 of a register, counted from the lowest, 0; `7/40001` is register 40001
/// of unit 7. A Problem has `where` "column 7", counted in bytes from 1, and a text that says what
/// was found and what was expected.
[[nodiscard]] BUSBAR_API Configured<ModbusAddress> parse_modbus_address(std::string_view text);

/// Returns the canonical form, which has names and offsets from 0 and leaves out what is the
/// default: "holding:0:float:CDAB". Reads as the same address again.
[[nodiscard]] BUSBAR_API std::string to_text(const ModbusAddress& address);

} // namespace busbar::backend
