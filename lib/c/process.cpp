#include <algorithm>
#include <string>

#include <busbar/busbar.h>
#include <busbar/core/status_codes.hpp>
#include <busbar/core/text.hpp>
#include <busbar/core/version.hpp>
#include <busbar/crypto/password_hash.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/worst_case_memory.hpp>

#include "guard.hpp"

using namespace busbar;

const char* busbar_version(void)
{
    return version();
}

const char* busbar_status_name(busbar_status status)
{
    const std::string_view text = name(StatusCode{status}); // of a literal, or empty
    return text.empty() ? "" : text.data();
}

busbar_time busbar_now(void)
{
    return net::SystemWallClock{}.now().ticks;
}

busbar_time busbar_time_of_unix(int64_t seconds, int32_t nanoseconds)
{
    constexpr std::int64_t furthest = DateTime::latest / DateTime::ticks_per_second;
    return DateTime::from_unix_seconds(std::clamp(seconds, -furthest, furthest)).ticks +
           nanoseconds / 100;
}

busbar_status busbar_hash_password(const char* password, uint32_t iterations, char* hash,
                                   size_t size)
{
    return c::run_guarded(nullptr, [&]() -> StatusCode {
        if (password == nullptr || hash == nullptr) {
            return status::Bad_InvalidArgument;
        }
        crypto::PasswordCost cost;
        if (iterations != 0) {
            cost.scheme = crypto::PasswordScheme::Pbkdf2;
            cost.iterations = iterations;
        }
        crypto::SystemRandom random;
        const auto made = crypto::hash_password(password, random, cost);
        if (!made) {
            return made.error();
        }
        if (made->size() >= size) {
            return status::Bad_OutOfRange;
        }
        std::copy_n(made->c_str(), made->size() + 1, hash);
        return status::Good;
    });
}

uint64_t busbar_memory_needed(int limits)
{
    std::uint64_t bytes = 0;
    static_cast<void>(c::run_guarded(nullptr, [&] {
        if (limits == BUSBAR_LIMITS_LARGE || limits == BUSBAR_LIMITS_SMALL) {
            bytes = server::worst_case_memory(limits == BUSBAR_LIMITS_SMALL
                                                  ? server::small_controller_limits()
                                                  : server::ServerLimits{})
                        .total();
        }
        return status::Good;
    }));
    return bytes;
}
