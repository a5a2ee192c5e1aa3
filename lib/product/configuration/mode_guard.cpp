#include "mode_guard.hpp"

#include <array>
#include <string>
#include <utility>

namespace busbar::product {

namespace {

constexpr std::array<std::string_view, 7> guarded{
    "machine.use",
    "server.port",
    "machine.execution_log",
    "machine.execution_log_files",
    "machine.execution_log_records",
    "endpoint",
    "users.anonymous",
};

/// Returns a table with only this key, if it is present.
toml::table part_of(const toml::table& table, std::string_view key)
{
    toml::table part;
    if (const toml::node* const node = table.get(key)) {
        part.insert(key, *node);
    }
    return part;
}

} // namespace

std::span<const std::string_view> program_only_settings()
{
    return guarded;
}

Configured<void> check_in_run(const administration::SettingValues& now,
                              const administration::SettingValues& next)
{
    for (const std::string_view name : guarded) {
        const auto before = now.find(name);
        const auto after = next.find(name);
        if (before != now.end() && after != next.end() && !(before->second == after->second)) {
            return refused_in_run(std::string{name});
        }
    }
    return {};
}

Configured<void> check_file_in_run(const toml::table& now, const toml::table& next)
{
    for (const auto& [key, what] :
         {std::pair{"users", "users and roles"}, std::pair{"endpoint", "endpoint"},
          std::pair{"security", "security"}}) {
        if (part_of(now, key) != part_of(next, key)) {
            return refused_in_run(what);
        }
    }
    return {};
}

Unexpected<Problem> refused_in_run(std::string what)
{
    return misconfigured(std::move(what),
                         "cannot change while the machine is in RUN; set machine.mode to PROGRAM "
                         "before",
                         status::Bad_InvalidState);
}

} // namespace busbar::product
