#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/backend/modbus_pdu.hpp>

namespace busbar::backend::detail {

/// The parts of a function's requests.
struct ModbusForm {
    ModbusFunction function;
    bool has_bits;
    /// Maximum number of items to read and to write; 0: none.
    std::size_t max_read;
    std::size_t max_write;
    /// Exactly one item is written, and there is no quantity.
    bool is_single;
};

/// Returns the form of a function; null if it is unknown.
[[nodiscard]] const ModbusForm* modbus_form(std::uint8_t function);

/// Bit of a response's function code that says that it is an exception.
inline constexpr std::uint8_t exception_bit = 0x80;
/// MEI type of the identification (6.21).
inline constexpr std::uint8_t identification_mei = 14;
/// Value of a coil that is on in function 5 (6.5).
inline constexpr std::uint16_t coil_on = 0xFF00;
/// The first item that does not exist.
inline constexpr std::size_t end_of_modbus_items = 0x1'0000;

} // namespace busbar::backend::detail
