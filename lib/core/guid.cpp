#include <busbar/core/guid.hpp>

#include <cstdio>
#include <string>

namespace busbar {

namespace {

constexpr std::size_t text_size = 36;

int hex_digit(char c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// Reads the 32 digits of the text as 16 bytes in their order.
bool read_digits(std::string_view text, std::array<std::uint8_t, 16>& bytes)
{
    std::size_t digit = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (i == 8 || i == 13 || i == 18 || i == 23) {
            if (text[i] != '-') {
                return false;
            }
            continue;
        }
        const int value = hex_digit(text[i]);
        if (value < 0) {
            return false;
        }
        auto& byte = bytes[digit / 2];
        byte = static_cast<std::uint8_t>(byte << 4U | value);
        ++digit;
    }
    return true;
}

} // namespace

Result<Guid> Guid::parse(std::string_view text)
{
    std::array<std::uint8_t, 16> b{};
    if (text.size() != text_size || !read_digits(text, b)) {
        return fail(status::Bad_DecodingError);
    }
    Guid guid;
    guid.data1 =
        std::uint32_t{b[0]} << 24U | std::uint32_t{b[1]} << 16U | std::uint32_t{b[2]} << 8U | b[3];
    guid.data2 = static_cast<std::uint16_t>(b[4] << 8U | b[5]);
    guid.data3 = static_cast<std::uint16_t>(b[6] << 8U | b[7]);
    for (std::size_t i = 0; i < guid.data4.size(); ++i) {
        guid.data4[i] = b[8 + i];
    }
    return guid;
}

std::string to_string(const Guid& g)
{
    std::array<char, text_size + 1> buffer{};
    static_cast<void>(std::snprintf(
        buffer.data(), buffer.size(), "%08X-%04X-%04X-%02X%02X-%02X%02X%02X%02X%02X%02X", g.data1,
        unsigned{g.data2}, unsigned{g.data3}, unsigned{g.data4[0]}, unsigned{g.data4[1]},
        unsigned{g.data4[2]}, unsigned{g.data4[3]}, unsigned{g.data4[4]}, unsigned{g.data4[5]},
        unsigned{g.data4[6]}, unsigned{g.data4[7]}));
    return std::string{buffer.data(), text_size};
}

} // namespace busbar
