#include <string_view>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/modbus_address.hpp>
#include <busbar/backend/modbus_pdu.hpp>

#include "require.hpp"

namespace address_text_fuzz {

using namespace busbar;
using busbar::fuzz::require;

namespace {

/// An address of a PLC in each family: it has a place for all of its words, or a reason.
void check_slmp(std::string_view text)
{
    using enum backend::SlmpFamily;
    for (const auto family : {Auto, IqR, Q, QModule, Fx5}) {
        const auto point = backend::parse_slmp_point(text, backend::slmp_options(family));
        if (!point) {
            require(!point.error().where.empty() && !point.error().text.empty());
            require(point.error().text.size() < text.size() + 400);
            continue;
        }
        require(point->address.width >= 1 && point->address.width <= 960);
        const auto protocol =
            backend::make_slmp_protocol(backend::slmp_options(family), {&*point, 1});
        require(protocol->plan().rules.size() >= 1);
    }
}

} // namespace

/// An address that is read is written as a text that is read as the same, and lies in its table.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    check_slmp(text);
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
