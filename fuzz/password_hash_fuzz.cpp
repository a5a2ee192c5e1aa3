#include <cstdint>
#include <string_view>

#include <busbar/crypto/password_hash.hpp>

using namespace busbar;

namespace {

/// The second part, which is the logarithm of the cost, has one digit: others take too long here.
bool is_cheap(std::string_view stored)
{
    constexpr std::string_view beginning = "$scrypt$";
    return stored.size() > beginning.size() + 3 && stored[beginning.size() + 1] == '$' &&
           stored[beginning.size() + 3] == '$';
}

} // namespace

/// Any text as the hash of a password: what is one is always of the same passwords.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string_view stored{reinterpret_cast<const char*>(data), size};
    const bool is_hash = crypto::is_password_hash(stored);
    if (!is_hash || is_cheap(stored)) {
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
