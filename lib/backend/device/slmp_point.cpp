#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>

#include <busbar/backend/device_protocols.hpp>
#include <busbar/backend/modbus_address.hpp>

#include "core/ascii_case.hpp"
#include "slmp_request.hpp"

namespace busbar::backend {

namespace detail {

namespace {

constexpr std::uint32_t first_direct = 0xF7;

} // namespace

std::uint32_t area_of(const SlmpDevice& device)
{
    const std::uint32_t direct =
        device.direct_memory == 0 ? 0U : device.direct_memory - first_direct;
    return static_cast<std::uint32_t>(device.extension) << 16U | direct << 8U | device.code;
}

SlmpDevice device_of(const PlanAddress& address)
{
    SlmpDevice device;
    device.code = static_cast<std::uint16_t>(address.area & 0xFFU);
    const std::uint32_t direct = address.area >> 8U & 3U;
    device.direct_memory = static_cast<std::uint8_t>(direct == 0 ? 0U : direct + first_direct);
    device.extension = static_cast<std::uint16_t>(address.area >> 16U);
    device.number = address.offset;
    return device;
}

SlmpUnit unit_of(std::uint32_t area)
{
    const auto* const type = find_slmp_device_type(static_cast<std::uint16_t>(area & 0xFFU));
    return type != nullptr ? type->unit : SlmpUnit::Word;
}

bool is_extended(std::uint32_t area)
{
    return (area >> 8U & 3U) != 0;
}

} // namespace detail

namespace {

using busbar::detail::is_same_ignoring_case;
using detail::area_of;
using detail::unit_of;

/// Whether the last part of ":int32:CDAB" is an order.
bool ends_with_order(std::string_view text)
{
    constexpr std::array<std::string_view, 6> orders{"ABCD", "CDAB", "BADC", "DCBA", "AB", "BA"};
    const std::string_view last = text.substr(text.rfind(':') + 1);
    return std::ranges::any_of(orders,
                               [&](auto each) { return is_same_ignoring_case(last, each); });
}

constexpr std::string_view any_register = "holding:0";

/// Reads ":int32:CDAB" by the rules of Modbus, from which a PLC's lowest word first differs. `at`
/// is where it begins, for a Problem.
Configured<ModbusValueType> parse_type(std::string_view text, std::size_t at)
{
    auto address = parse_modbus_address(std::string{any_register} + std::string{text});
    if (!address) {
        Problem problem = std::move(address).error();
        constexpr std::string_view column = "column ";
        std::size_t number = 0;
        if (problem.where.starts_with(column)) {
            const char* const begin = problem.where.data() + column.size();
            static_cast<void>(
                std::from_chars(begin, problem.where.data() + problem.where.size(), number));
            problem.where = std::string{column} + std::to_string(number + at - any_register.size());
        }
        return Unexpected{std::move(problem)};
    }
    ModbusValueType type = address->value;
    if (!ends_with_order(text)) {
        const bool is_text = type.type == ModbusType::Text;
        const bool has_words = registers_of(type) > 1;
        type.order = is_text     ? ModbusOrder::BADC
                     : has_words ? ModbusOrder::CDAB
                                 : ModbusOrder::ABCD;
    }
    return type;
}

Configured<DevicePoint> refused(std::size_t column, const std::string& text)
{
    return Unexpected{Problem{.where = "column " + std::to_string(column), .text = text}};
}

} // namespace

Configured<DevicePoint> parse_slmp_point(std::string_view text, const SlmpProtocolOptions& options)
{
    const std::size_t end = std::min(text.find(':'), text.size());
    const auto address = parse_slmp_address(text.substr(0, end), options.notation);
    if (!address) {
        return Unexpected{address.error()};
    }
    const SlmpUnit unit = unit_of(address->device.code);
    if (options.family == SlmpFamily::Auto && detail::is_io({area_of(address->device), 0, 1}) &&
        address->device.number > 7) {
        return refused(2, "found \"" + std::string{text.substr(1, end - 1)} +
                              "\" of X or Y, which is octal for FX5 and hexadecimal for others: "
                              "expected the PLC's family to be set");
    }
    DevicePoint point;
    point.address.area = area_of(address->device);
    point.address.offset = address->device.number;
    if (unit == SlmpUnit::LongTimer) {
        return refused(1,
                       "found a long timer, expected its contact (LTS) or coil (LTC): four words "
                       "of three values are not read");
    }
    if (unit == SlmpUnit::Bit || address->bit) {
        point.type.type = ModbusType::Bool;
        point.bit = address->bit;
        point.is_writable = !address->bit;
        return end == text.size() ? Configured<DevicePoint>{point}
                                  : refused(end + 1, "found \"" + std::string{text.substr(end)} +
                                                         "\", expected nothing: it is a bit");
    }
    if (unit == SlmpUnit::DoubleWord) {
        point.type = {ModbusType::Int32, ModbusOrder::CDAB};
    }
    if (end != text.size()) {
        auto type = parse_type(text.substr(end), end);
        if (!type) {
            return Unexpected{std::move(type).error()};
        }
        point.type = *type;
    }
    const auto words = static_cast<std::uint32_t>(registers_of(point.type));
    if (unit == SlmpUnit::DoubleWord && words != 2) {
        return refused(end + 1, "found a type of " + std::to_string(words) +
                                    " words, expected one of two: int32, uint32, float or bcd32");
    }
    if (point.type.type == ModbusType::Bool) {
        return refused(end + 1, "found bool for a word, expected a bit of it, such as D10.3");
    }
    point.address.width = unit == SlmpUnit::DoubleWord ? 1 : words;
    point.is_writable = true;
    return point;
}

} // namespace busbar::backend
