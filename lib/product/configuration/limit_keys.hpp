#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "config.hpp"

namespace busbar::product {

/// A limit that a configuration can set, and what it may be set to.
struct LimitKey {
    /// The table and the key: "limits.subscriptions", "items".
    std::string_view table;
    std::string_view name;
    /// The member of ServerLimits, as worst_case_memory names it; of limits of other things empty.
    std::string_view limit;
    /// "B", "ms", "%" or empty for a count.
    std::string_view unit;
    std::int64_t least;
    std::int64_t most;
    std::int64_t (*get)(const ControllerConfig& config);
    void (*set)(ControllerConfig& config, std::int64_t value);
};

/// All of them, table by table. What is no whole number, and so not here, is read by read_limits.
[[nodiscard]] std::span<const LimitKey> limit_keys();

} // namespace busbar::product
