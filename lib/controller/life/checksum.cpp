#include "checksum.hpp"

#include <array>

namespace busbar::controller::detail {

namespace {

/// Number of bytes processed at a time.
constexpr std::size_t slice = 8;

/// The remainder of each byte, followed by 0 to 7 zeros.
constexpr std::array<std::array<std::uint32_t, 256>, slice> make_checksum_tables()
{
    constexpr std::uint32_t polynomial = 0xEDB88320U;
    std::array<std::array<std::uint32_t, 256>, slice> tables{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t rest = byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest >> 1U) ^ ((rest & 1U) != 0 ? polynomial : 0U);
        }
        tables[0][byte] = rest;
    }
    for (std::size_t zeros = 1; zeros < slice; ++zeros) {
        for (std::size_t byte = 0; byte < 256; ++byte) {
            const std::uint32_t rest = tables[zeros - 1][byte];
            tables[zeros][byte] = (rest >> 8U) ^ tables[0][rest & 0xFFU];
        }
    }
    return tables;
}

constexpr auto tables = make_checksum_tables();

} // namespace

std::uint32_t checksum(std::span<const std::byte> bytes)
{
    std::uint32_t rest = ~0U;
    while (bytes.size() >= slice) {
        std::uint32_t next = 0;
        for (std::size_t i = 0; i < slice; ++i) {
            // The first four bytes are combined with the remainder so far.
            const std::uint32_t before = i < 4 ? rest >> (8U * i) : 0U;
            const std::uint32_t byte = std::to_integer<std::uint32_t>(bytes[i]);
            next ^= tables[slice - 1 - i][(before ^ byte) & 0xFFU];
        }
        rest = next;
        bytes = bytes.subspan(slice);
    }
    for (const std::byte byte : bytes) {
        rest = (rest >> 8U) ^ tables[0][(rest ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
    }
    return ~rest;
}

std::string checksum_text(std::string_view text)
{
    constexpr std::string_view digits = "0123456789abcdef";
    const std::uint32_t sum = checksum(std::as_bytes(std::span{text}));
    std::string written(8, '0');
    for (std::size_t i = 0; i < written.size(); ++i) {
        written[i] = digits[sum >> (28U - 4U * i) & 15U];
    }
    return written;
}

} // namespace busbar::controller::detail
