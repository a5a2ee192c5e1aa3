#include <span>
#include <string>

#include <catch2/catch.hpp>

#include <busbar/crypto/digest.hpp>

namespace digest_test {

using namespace busbar;

TEST_CASE("SHA-256 has the value of its standard's first example", "[crypto]")
{
    const std::string text = "abc";
    std::string hex;
    for (const std::byte byte : crypto::sha256(std::as_bytes(std::span{text}))) {
        constexpr std::string_view digits = "0123456789abcdef";
        hex += digits[std::to_integer<std::size_t>(byte) / digits.size()];
        hex += digits[std::to_integer<std::size_t>(byte) % digits.size()];
    }
    CHECK(hex == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

} // namespace digest_test
