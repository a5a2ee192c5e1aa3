#include "checksum.hpp"

#include <array>

namespace busbar::controller::detail {

namespace {

constexpr std::array<std::uint32_t, 256> make_checksum_table()
{
    constexpr std::uint32_t polynomial = 0xEDB88320U;
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
        std::uint32_t rest = byte;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest >> 1U) ^ ((rest & 1U) != 0 ? polynomial : 0U);
        }
        table[byte] = rest;
    }
    return table;
}

constexpr auto checksum_table = make_checksum_table();

} // namespace

std::uint32_t checksum(std::span<const std::byte> bytes)
{
    std::uint32_t rest = ~0U;
    for (const std::byte byte : bytes) {
        rest = (rest >> 8U) ^ checksum_table[(rest ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
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
