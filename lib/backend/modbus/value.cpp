#include <busbar/backend/modbus_value.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <limits>
#include <string_view>

#include <busbar/core/string.hpp>

#include "core/utf8.hpp"

namespace busbar::backend {

namespace {

constexpr unsigned bits_of_word = 16;
constexpr unsigned bits_of_digit = 4;
constexpr std::uint64_t decimal = 10;

/// The properties of each type, in the order of the enumeration.
struct ModbusTypeRow {
    BuiltInType built_in;
    std::uint8_t registers;
};
constexpr std::array modbus_type_rows{
    ModbusTypeRow{BuiltInType::Boolean, 1}, ModbusTypeRow{BuiltInType::Int16, 1},
    ModbusTypeRow{BuiltInType::UInt16, 1},  ModbusTypeRow{BuiltInType::Int32, 2},
    ModbusTypeRow{BuiltInType::UInt32, 2},  ModbusTypeRow{BuiltInType::Int64, 4},
    ModbusTypeRow{BuiltInType::UInt64, 4},  ModbusTypeRow{BuiltInType::Float, 2},
    ModbusTypeRow{BuiltInType::Double, 4},  ModbusTypeRow{BuiltInType::UInt16, 1},
    ModbusTypeRow{BuiltInType::UInt32, 2},  ModbusTypeRow{BuiltInType::UInt64, 4},
    ModbusTypeRow{BuiltInType::String, 0},
};
static_assert(modbus_type_rows.size() == static_cast<std::size_t>(ModbusType::Text) + 1);

[[nodiscard]] bool swaps_bytes(ModbusOrder order)
{
    return order == ModbusOrder::BADC || order == ModbusOrder::DCBA;
}

[[nodiscard]] bool is_low_word_first(ModbusOrder order)
{
    return order == ModbusOrder::CDAB || order == ModbusOrder::DCBA;
}

[[nodiscard]] std::uint16_t ordered(std::uint16_t word, ModbusOrder order)
{
    return swaps_bytes(order) ? static_cast<std::uint16_t>(word << 8U | word >> 8U) : word;
}

/// Registers as one number, whose lowest bits are used.
[[nodiscard]] std::uint64_t join(std::span<const std::uint16_t> registers, ModbusOrder order)
{
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < registers.size(); ++i) {
        const std::size_t at = is_low_word_first(order) ? registers.size() - 1 - i : i;
        number = number << bits_of_word | ordered(registers[at], order);
    }
    return number;
}

void split(std::uint64_t number, ModbusOrder order, std::span<std::uint16_t> registers)
{
    for (std::size_t i = 0; i < registers.size(); ++i) {
        const std::size_t at = is_low_word_first(order) ? i : registers.size() - 1 - i;
        registers[at] = ordered(static_cast<std::uint16_t>(number), order);
        number >>= bits_of_word;
    }
}

[[nodiscard]] Result<std::uint64_t> from_bcd(std::uint64_t digits)
{
    std::uint64_t number = 0;
    for (unsigned shift = std::numeric_limits<std::uint64_t>::digits; shift != 0;) {
        shift -= bits_of_digit;
        const std::uint64_t digit = digits >> shift & 0xFU;
        if (digit >= decimal) {
            return fail(status::Bad_DecodingError);
        }
        number = number * decimal + digit;
    }
    return number;
}

/// Bad_OutOfRange if it has more digits than `count` registers.
[[nodiscard]] Result<std::uint64_t> to_bcd(std::uint64_t number, std::size_t count)
{
    std::uint64_t digits = 0;
    for (unsigned shift = 0; shift != count * bits_of_word; shift += bits_of_digit) {
        digits |= number % decimal << shift;
        number /= decimal;
    }
    return number == 0 ? Result<std::uint64_t>{digits} : fail(status::Bad_OutOfRange);
}

[[nodiscard]] Result<Variant> read_text(const ModbusValueType& type,
                                        std::span<const std::uint16_t> registers)
{
    std::string text;
    text.reserve(2 * registers.size());
    for (const std::uint16_t word : registers) {
        const std::uint16_t both = ordered(word, type.order);
        text.push_back(static_cast<char>(both >> 8U));
        text.push_back(static_cast<char>(both & 0xFFU));
    }
    text.resize(std::min<std::size_t>(text.size(), type.length));
    text.resize(std::min(text.size(), text.find('\0')));
    if (!busbar::detail::is_utf8(text)) {
        return fail(status::Bad_DecodingError);
    }
    return Variant{String{text}};
}

[[nodiscard]] StatusCode write_text(const ModbusValueType& type, std::string_view text,
                                    std::span<std::uint16_t> registers)
{
    if (text.size() > type.length || text.find('\0') != std::string_view::npos) {
        return status::Bad_OutOfRange;
    }
    const auto byte_at = [text](std::size_t at) {
        return at < text.size() ? static_cast<unsigned char>(text[at]) : 0U;
    };
    for (std::size_t i = 0; i < registers.size(); ++i) {
        const unsigned both = byte_at(2 * i) << 8U | byte_at(2 * i + 1);
        registers[i] = ordered(static_cast<std::uint16_t>(both), type.order);
    }
    return status::Good;
}

[[nodiscard]] Variant unsigned_of(std::uint64_t number, BuiltInType type)
{
    switch (type) {
    case BuiltInType::UInt16:
        return static_cast<std::uint16_t>(number);
    case BuiltInType::UInt32:
        return static_cast<std::uint32_t>(number);
    default:
        return number;
    }
}

[[nodiscard]] Variant number_of(std::uint64_t bits, BuiltInType type)
{
    switch (type) {
    case BuiltInType::Boolean:
        return bits != 0;
    case BuiltInType::Int16:
        return static_cast<std::int16_t>(bits);
    case BuiltInType::Int32:
        return static_cast<std::int32_t>(bits);
    case BuiltInType::Int64:
        return static_cast<std::int64_t>(bits);
    case BuiltInType::Float:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case BuiltInType::Double:
        return std::bit_cast<double>(bits);
    default:
        return unsigned_of(bits, type);
    }
}

/// A number's bits; those of a negative one beyond its size do not count.
[[nodiscard]] std::uint64_t bits_of(const Variant& value)
{
    switch (value.type()) {
    case BuiltInType::Boolean:
        return value.value_or(false) ? 1 : 0;
    case BuiltInType::Int16:
        return static_cast<std::uint64_t>(value.value_or(std::int16_t{0}));
    case BuiltInType::UInt16:
        return value.value_or(std::uint16_t{0});
    case BuiltInType::Int32:
        return static_cast<std::uint64_t>(value.value_or(std::int32_t{0}));
    case BuiltInType::UInt32:
        return value.value_or(std::uint32_t{0});
    case BuiltInType::Int64:
        return static_cast<std::uint64_t>(value.value_or(std::int64_t{0}));
    case BuiltInType::UInt64:
        return value.value_or(std::uint64_t{0});
    case BuiltInType::Float:
        return std::bit_cast<std::uint32_t>(value.value_or(0.0F));
    case BuiltInType::Double:
        return std::bit_cast<std::uint64_t>(value.value_or(0.0));
    default:
        return 0;
    }
}

[[nodiscard]] bool is_bcd(ModbusType type)
{
    return type == ModbusType::Bcd16 || type == ModbusType::Bcd32 || type == ModbusType::Bcd64;
}

} // namespace

std::size_t registers_of(const ModbusValueType& type)
{
    return type.type == ModbusType::Text
               ? (type.length + std::size_t{1}) / 2
               : modbus_type_rows[static_cast<std::size_t>(type.type)].registers;
}

BuiltInType data_type_of(ModbusType type)
{
    return modbus_type_rows[static_cast<std::size_t>(type)].built_in;
}

Result<Variant> read_modbus(const ModbusValueType& type, std::span<const std::uint16_t> registers)
{
    if (registers.size() != registers_of(type)) {
        return fail(status::Bad_DecodingError);
    }
    if (type.type == ModbusType::Text) {
        return read_text(type, registers);
    }
    const std::uint64_t bits = join(registers, type.order);
    if (!is_bcd(type.type)) {
        return number_of(bits, data_type_of(type.type));
    }
    const auto number = from_bcd(bits);
    if (!number) {
        return fail(number.error());
    }
    return unsigned_of(*number, data_type_of(type.type));
}

StatusCode write_modbus(const ModbusValueType& type, const Variant& value,
                        std::span<std::uint16_t> registers)
{
    if (!value.is_scalar() || value.type() != data_type_of(type.type)) {
        return status::Bad_TypeMismatch;
    }
    if (registers.size() != registers_of(type)) {
        return status::Bad_OutOfRange;
    }
    if (type.type == ModbusType::Text) {
        return write_text(type, value.value_or(String{}).view(), registers);
    }
    std::uint64_t bits = bits_of(value);
    if (is_bcd(type.type)) {
        const auto digits = to_bcd(bits, registers.size());
        if (!digits) {
            return digits.error();
        }
        bits = *digits;
    }
    split(bits, type.order, registers);
    return status::Good;
}

} // namespace busbar::backend
