#include <cstdint>
#include <string_view>

#include <busbar/crypto/password_hash.hpp>

namespace password_hash_fuzz {

using namespace busbar;

namespace {

/// Others take too long here.
bool is_cheap(const crypto::PasswordCost& cost)
{
    return cost.scheme == crypto::PasswordScheme::Pbkdf2 ? cost.iterations < 10'000
                                                         : cost.log_n < 10;
}

} // namespace

/// Any text as the hash of a password: what is one is always of the same passwords.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const std::string_view stored{reinterpret_cast<const char*>(data), size};
    const auto cost = crypto::cost_of(stored);
    const bool is_hash = crypto::is_password_hash(stored);
    if (is_hash != cost.has_value()) {
        __builtin_trap();
    }
    if (!is_hash || is_cheap(*cost)) {
        const bool fits = crypto::verify_password("Tank_4711", stored);
        if (fits && !is_hash) {
            __builtin_trap();
        }
        if (crypto::verify_password("Tank_4711", stored) != fits) {
            __builtin_trap();
        }
    }
    return 0;
}

} // namespace password_hash_fuzz
