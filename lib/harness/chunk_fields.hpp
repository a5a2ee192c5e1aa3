#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>

namespace busbar::harness::detail {

// Offsets in a MSG or CLO chunk (Part 6, 6.7.2.2 to 6.7.2.4).
inline constexpr std::size_t flag_offset = 3;
inline constexpr std::size_t size_offset = 4;
inline constexpr std::size_t channel_offset = 8;
inline constexpr std::size_t token_offset = 12;
inline constexpr std::size_t sequence_offset = 16;
inline constexpr std::size_t request_offset = 20;

/// The number at this place, which must be within the bytes.
[[nodiscard]] inline std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t offset)
{
    binary::Reader reader{bytes.subspan(offset)};
    return reader.number<std::uint32_t>();
}

/// Writes it there.
inline void set_number(std::span<std::byte> bytes, std::size_t offset, std::uint32_t number)
{
    binary::SpanSink sink{bytes.subspan(offset, sizeof number)};
    binary::Writer writer{sink};
    writer.number(number);
}

} // namespace busbar::harness::detail
