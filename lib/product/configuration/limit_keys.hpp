#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/server/worst_case_memory.hpp>

#include "config.hpp"

namespace busbar::product {

/// A limit's name and place in a document; without a name it is left out.
struct LimitEntry {
    int place{0};
    std::string_view name{};
};

/// An integer that a configuration sets: a limit of [limits] or of another section. Its row in
/// limit_keys() describes it completely: keys, checks, settings, presets and the output of
/// --print-limits, --print-capacities and --explain are made from the rows.
struct LimitKey {
    /// Table and key: "limits.subscriptions", "items".
    std::string_view table;
    std::string_view name;
    /// The row of server::worst_case_memory with its cost: the member of ServerLimits,
    /// "subscriptions.max_items". Empty for limits of other things.
    std::string_view cost;
    /// "B", "ms", "s", "d", "bit" or empty for a count.
    std::string_view unit;
    std::int64_t least;
    std::int64_t most;
    /// Entries in --print-capacities and in --print-preset.
    LimitEntry capacity;
    LimitEntry figure;
    /// True if administrators can change it online; otherwise only the file sets it.
    bool is_setting;
    /// True if a change takes effect at once.
    bool is_live;
    /// True if it belongs to the security profile (see is_security_setting).
    bool is_security;
    std::int64_t (*get)(const ControllerConfig& config);
    void (*set)(ControllerConfig& config, std::int64_t value);
};

/// All keys, table by table.
[[nodiscard]] std::span<const LimitKey> limit_keys();
/// Selects the keys with an entry in a document, in its order.
[[nodiscard]] std::vector<const LimitKey*> limits_in(LimitEntry LimitKey::*document);
/// Finds a key by its name, "limits.subscriptions.items"; null for unknown names.
[[nodiscard]] const LimitKey* find_limit(std::string_view setting);
[[nodiscard]] std::string setting_name(const LimitKey& key);
/// The key of [limits] that sets a limit, by the limit's name in server::MemoryRow:
/// "subscriptions.items"; empty if there is none.
[[nodiscard]] std::string key_of(std::string_view cost);
/// Sets the numbers that `table` has for keys of the table at `path`. Throws ConfigError.
void read_numbers(const TomlTable& table, std::string_view path, ControllerConfig& config);

/// Reads `memory` of [limits], the total that peers may make the controller hold; nothing without
/// it.
[[nodiscard]] std::optional<std::uint64_t> read_memory(const TomlTable& limits);
/// Sets the limits for that memory, before all other keys are read.
void take_memory(const TomlTable& root, std::uint64_t memory, ControllerConfig& config);
/// Refuses limits that other keys raised above that memory; ignores structures of a program's
/// image.
void check_memory(const TomlTable& limits, const ControllerConfig& config);

/// Computes the memory that peers can make a controller of this configuration hold at worst: with
/// the image of its program, or one without structures.
[[nodiscard]] server::WorstCaseMemory worst_case_of(const ControllerConfig& config,
                                                    const server::ProcessImage& image);
[[nodiscard]] server::WorstCaseMemory worst_case_of(const ControllerConfig& config);

/// Writes a size for people: "900 B", "64.0 KiB", "1.5 GiB".
[[nodiscard]] std::string size_text(std::uint64_t bytes);

} // namespace busbar::product
