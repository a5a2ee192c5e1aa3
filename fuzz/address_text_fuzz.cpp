#include <string_view>

#include <busbar/backend/modbus_address.hpp>
#include <busbar/backend/modbus_pdu.hpp>

#include "require.hpp"

namespace address_text_fuzz {

using namespace busbar;
using busbar::fuzz::require;

/// An address that is read is written as a text that is read as the same, and lies in its table.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    const auto address = backend::parse_modbus_address(text);
    if (!address) {
        require(!address.error().where.empty() && !address.error().text.empty());
        require(address.error().text.size() < 400);
        return 0;
    }
    const std::string written = backend::to_text(*address);
    const auto again = backend::parse_modbus_address(written);
    require(again.has_value() && *again == *address && backend::to_text(*again) == written);
    const std::size_t registers = backend::registers_of(address->value);
    require(registers != 0 && registers <= backend::max_modbus_read_registers);
    require(backend::has_bits(address->table) || address->offset + registers <= 0x1'0000);
    return 0;
}

} // namespace address_text_fuzz
