#include "label_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

#include <busbar/binary/wire_order.hpp>

#include "server/image/image_types.hpp"

namespace busbar::controller::detail {

namespace {

using backend::LabelKind;
using backend::LabelType;
using binary::detail::copy_number;
using binary::detail::copy_numbers;

/// Converts in both directions: swapping twice restores the bytes.
void copy_plain(std::size_t size, void* to, const void* from)
{
    switch (size) {
    case 2:
        copy_number<2>(to, from);
        break;
    case 4:
        copy_number<4>(to, from);
        break;
    default:
        copy_number<8>(to, from);
        break;
    }
}

/// The image stores a TIME as a Double.
void load_time(const std::byte* memory, std::byte* wire)
{
    double milliseconds = 0;
    std::memcpy(&milliseconds, memory, sizeof milliseconds);
    using Limits = std::numeric_limits<std::int32_t>;
    const double rounded = std::isnan(milliseconds) ? 0 : std::round(milliseconds);
    const auto value = static_cast<std::int32_t>(
        std::clamp(rounded, double{Limits::min()}, double{Limits::max()}));
    copy_number<sizeof value>(wire, &value);
}

void store_time(std::byte* memory, const std::byte* wire)
{
    std::int32_t value = 0;
    copy_number<sizeof value>(&value, wire);
    const double milliseconds = value;
    std::memcpy(memory, &milliseconds, sizeof milliseconds);
}

void load_text(std::uint32_t length, const std::byte* memory, std::byte* wire)
{
    const std::string_view text = server::detail::text_at(memory, length).value_or("");
    std::memset(wire, 0, std::size_t{length} + 1);
    std::memcpy(wire, text.data(), text.size());
}

void store_text(std::uint32_t length, std::byte* memory, const std::byte* wire)
{
    const std::string_view room{reinterpret_cast<const char*>(wire), length};
    server::detail::put_text(memory, room.substr(0, room.find('\0')));
}

/// Writes zeros from the first zero on, as the PLC's own program does when it assigns.
void store_utf16(std::uint32_t length, std::byte* memory, const std::byte* wire)
{
    constexpr std::size_t unit = 2;
    std::size_t units = 0;
    while (units < length &&
           (wire[units * unit] != std::byte{} || wire[units * unit + 1] != std::byte{})) {
        ++units;
    }
    std::memset(memory, 0, (std::size_t{length} + 1) * unit);
    copy_numbers<unit>(memory, wire, units);
}

} // namespace

void load_label(const LabelKind& kind, const std::byte* memory, std::byte* wire)
{
    switch (value_type(kind.type, kind.part)) {
    case LabelType::Bit:
        *wire = *memory == std::byte{} ? std::byte{0} : std::byte{1};
        break;
    case LabelType::Time:
        load_time(memory, wire);
        break;
    case LabelType::String:
        load_text(kind.length, memory, wire);
        break;
    case LabelType::UnicodeString:
        copy_numbers<2>(wire, memory, std::size_t{kind.length} + 1);
        break;
    default:
        copy_plain(size_of(kind), wire, memory);
        break;
    }
}

void store_label(const LabelKind& kind, std::byte* memory, const std::byte* wire)
{
    switch (value_type(kind.type, kind.part)) {
    case LabelType::Bit:
        *memory = *wire == std::byte{} ? std::byte{0} : std::byte{1};
        break;
    case LabelType::Time:
        store_time(memory, wire);
        break;
    case LabelType::String:
        store_text(kind.length, memory, wire);
        break;
    case LabelType::UnicodeString:
        store_utf16(kind.length, memory, wire);
        break;
    default:
        copy_plain(size_of(kind), memory, wire);
        break;
    }
}

} // namespace busbar::controller::detail
