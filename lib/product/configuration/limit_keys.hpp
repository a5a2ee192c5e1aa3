#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config.hpp"

namespace busbar::product {

/// What a document calls a limit, and its place there; not in the document without a name.
struct LimitEntry {
    int place{0};
    std::string_view name{};
};

/// A whole number that a configuration sets: a limit of [limits] or of another section. Its row in
/// limit_keys() is all that there is to say of it: keys, checks, settings, presets and what
/// --print-limits, --print-capacities and --explain print are made of the rows.
struct LimitKey {
    /// The table and the key: "limits.subscriptions", "items".
    std::string_view table;
    std::string_view name;
    /// The row of server::worst_case_memory that says what it costs: the member of ServerLimits,
    /// "subscriptions.max_items". Empty for limits of other things.
    std::string_view cost;
    /// "B", "ms", "s", "d", "bit" or empty for a count.
    std::string_view unit;
    std::int64_t least;
    std::int64_t most;
    /// In --print-capacities and in --print-preset.
    LimitEntry capacity;
    LimitEntry figure;
    /// Administrators change it online. The file alone says what is no setting.
    bool is_setting;
    /// A change is in force at once.
    bool is_live;
    /// It is of the security profile (see is_security_setting).
    bool is_security;
    std::int64_t (*get)(const ControllerConfig& config);
    void (*set)(ControllerConfig& config, std::int64_t value);
};

/// All of them, table by table.
[[nodiscard]] std::span<const LimitKey> limit_keys();
/// Those with an entry in a document, in its order.
[[nodiscard]] std::vector<const LimitKey*> limits_in(LimitEntry LimitKey::*document);
/// Null if there is none of this name: "limits.subscriptions.items".
[[nodiscard]] const LimitKey* find_limit(std::string_view setting);
[[nodiscard]] std::string setting_name(const LimitKey& key);
/// The key of [limits] that sets a limit, by the limit's name in server::MemoryRow:
/// "subscriptions.items"; empty if none does.
[[nodiscard]] std::string key_of(std::string_view cost);
/// Sets what `table` says of the keys of the table at `path`. Throws ConfigError.
void read_numbers(const TomlTable& table, std::string_view path, ControllerConfig& config);

} // namespace busbar::product
