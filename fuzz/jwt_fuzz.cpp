#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "crypto/jwt_maker.hpp"
#include "fuzz_script.hpp"

namespace jwt_fuzz {

using namespace busbar;

namespace {

constexpr std::string_view secret = "0123456789abcdef0123456789abcdef";
constexpr DateTime now = DateTime::from_unix_seconds(1'767'225'600);

std::string_view text_of(std::span<const std::byte> bytes)
{
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

const crypto::JwtRules& rules()
{
    static const crypto::JwtRules made = [] {
        crypto::JwtRules rules;
        rules.keys = {
            crypto::JwtKey::from_shared_secret(std::as_bytes(std::span{secret}), "k").value()};
        return rules;
    }();
    return made;
}

} // namespace

/// Any text as a JSON Web Token; or any header and claims, signed with the right key.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    fuzz::Script script{{data, size}};
    const std::size_t header_size = script.byte();
    if (header_size == 0) {
        static_cast<void>(crypto::verify_jwt(text_of(script.bytes(size)), rules(), "urn:a", now));
        return 0;
    }
    const std::string_view header = text_of(script.bytes(header_size));
    const auto claims = crypto::verify_jwt(
        test::hmac_token(header, text_of(script.bytes(size)), secret), rules(), "urn:a", now);
    if (claims && (claims->subject.empty() || claims->expires.is_null())) {
        std::abort();
    }
    return 0;
}

} // namespace jwt_fuzz
