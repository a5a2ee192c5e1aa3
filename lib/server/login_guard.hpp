#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/clock.hpp>
#include <busbar/server/limits.hpp>

namespace busbar::server::detail {

/// Counts the failed logins of each client, so that passwords cannot be guessed by trying (Part 4,
/// 5.6.3.1). Bounded: past its limit the entry that failed longest ago is forgotten.
class LoginGuard {
public:
    explicit LoginGuard(const ServerLimits& limits) : limits_{&limits} {}

    /// True while the client is locked out: refuse without looking at the password.
    [[nodiscard]] bool is_locked(std::string_view client, TimePoint now) const;
    /// Counts a failure; how long its answer has to wait.
    [[nodiscard]] Duration failed(std::string_view client, TimePoint now);
    void succeeded(std::string_view client);

private:
    struct Entry {
        std::string client;
        std::size_t failures{0};
        TimePoint last;
    };
    [[nodiscard]] const Entry* find(std::string_view client) const;
    [[nodiscard]] Entry& entry(std::string_view client);

    const ServerLimits* limits_;
    std::vector<Entry> entries_;
};

} // namespace busbar::server::detail
