#include "controller/life/checksum.hpp"

#include <catch2/catch.hpp>

#include <span>
#include <string>

namespace checksum_test {

using namespace busbar::controller::detail;

TEST_CASE("checksum: the check value of CRC-32, and every length over two slices")
{
    CHECK(checksum_text("123456789") == "cbf43926");
    CHECK(checksum_text("") == "00000000");
    std::string text;
    for (int length = 0; length < 20; ++length) {
        INFO(length);
        std::uint32_t rest = ~0U;
        for (const char each : text) {
            rest ^= static_cast<std::uint8_t>(each);
            for (int bit = 0; bit < 8; ++bit) {
                rest = (rest >> 1U) ^ ((rest & 1U) != 0 ? 0xEDB88320U : 0U);
            }
        }
        CHECK(checksum(std::as_bytes(std::span{text})) == ~rest);
        text += static_cast<char>(7 * length + 129);
    }
}

} // namespace checksum_test
