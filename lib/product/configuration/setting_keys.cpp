#include "setting_keys.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <busbar/channel/channel_types.hpp>

#include "limit_keys.hpp"
#include "sections.hpp"

namespace busbar::product {

namespace {

using administration::Setting;

Variant texts(std::initializer_list<const char*> list)
{
    Array<String> array;
    array.clear(); // not null
    for (const char* text : list) {
        array.push_back(String{text});
    }
    return Variant{std::move(array)};
}

Variant no_numbers()
{
    Array<std::int64_t> array;
    array.clear(); // not null
    return Variant{std::move(array)};
}

std::vector<Setting> server_settings()
{
    return {
        {.name = "server.name", .otherwise = Variant{"Busbar controller"}},
        {.name = "server.address", .otherwise = Variant{""}},
        {.name = "server.host_names", .otherwise = texts({})},
        {.name = "server.announce", .otherwise = texts({})},
        {.name = "server.nodesets", .otherwise = texts({})},
        {.name = "server.nodesets_strict", .otherwise = Variant{true}},
        {.name = "server.locales", .otherwise = texts({"en"})},
        {.name = "server.auditing", .otherwise = Variant{false}},
        {.name = "reverse_connect.urls", .otherwise = texts({})},
        {.name = "discovery.url", .otherwise = Variant{""}},
        {.name = "discovery.allow_none", .otherwise = Variant{false}},
        {.name = "discovery.server", .otherwise = texts({})},
    };
}

/// The settings of security; defaults are those of the product whose limits are chosen.
std::vector<Setting> security_settings(const ControllerConfig& preset)
{
    const server::PasswordRules& rules = preset.users.password_rules;
    Array<String> reserved;
    reserved.clear(); // not null
    for (const std::string& name : rules.reserved_names) {
        reserved.push_back(String{name});
    }
    return {
        {.name = "certificates.trust_all_clients", .otherwise = Variant{false}},
        {.name = "certificates.suppress", .otherwise = texts({})},
        {.name = "endpoint", .otherwise = endpoint_value({})},
        {.name = "users.anonymous", .otherwise = Variant{"no"}},
        {.name = "users.authorities", .otherwise = Variant{"standard"}},
        {.name = "users.certificates", .otherwise = Variant{"no"}},
        {.name = "users.passwords.needs_letters_and_digit",
         .otherwise = Variant{rules.needs_letters_and_digit}},
        {.name = "users.passwords.name_characters",
         .otherwise = Variant{String{rules.name_characters}}},
        {.name = "users.passwords.password_characters",
         .otherwise = Variant{String{rules.password_characters}}},
        {.name = "users.passwords.reserved_names", .otherwise = Variant{std::move(reserved)}},
        {.name = "limits.preset", .otherwise = Variant{""}},
        {.name = "limits.certificates.when_rejected_is_full", .otherwise = Variant{"oldest out"}},
        {.name = "limits.subscriptions.samples_each_scan", .otherwise = Variant{true}},
        {.name = "limits.subscriptions.sampling_intervals_ms",
         .otherwise = no_numbers(),
         .unit = "ms"},
        {.name = "limits.subscriptions.overload_percent",
         .otherwise = Variant{0.0},
         .range = Range{0, 1'000},
         .unit = "%"},
    };
}

/// The settings of the machine (W588, 3-2-2).
std::vector<Setting> machine_settings()
{
    return {
        {.name = "machine.name", .otherwise = Variant{""}},
        {.name = "machine.use", .otherwise = Variant{true}},
        {.name = "machine.mode", .otherwise = Variant{"RUN"}},
        {.name = "machine.execution_log", .otherwise = Variant{false}},
    };
}

std::vector<Setting> plc_settings()
{
    return {
        {.name = "plc.variable", .otherwise = texts({})},
        {.name = "plc.program", .otherwise = texts({})},
        {.name = "plc.event", .otherwise = texts({})},
    };
}

void append(std::vector<Setting>& all, std::vector<Setting> more)
{
    std::move(more.begin(), more.end(), std::back_inserter(all));
}

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

Variant endpoint_value(const server::ServerConfig& config)
{
    Array<String> list;
    for (const server::EndpointConfig& endpoint : config.endpoints) {
        const auto& [policy, mode] = endpoint.security;
        list.push_back(String{"{ mode = '" + std::string{channel::name(mode)} + "', policy = '" +
                              std::string{policy->name} + "' }"});
    }
    return Variant{std::move(list)};
}

std::string setting_name(const SubjectKey& key)
{
    return "certificates." + std::string{key.name};
}

std::vector<Setting> controller_settings(const toml::table& file)
{
    ControllerConfig preset;
    SourceFiles sources;
    read_preset(TomlTable{file, "", sources}, preset);
    std::vector<Setting> settings = server_settings();
    append(settings, security_settings(preset));
    append(settings, machine_settings());
    append(settings, plc_settings());
    for (const SubjectKey& key : subject_keys) {
        settings.push_back({.name = setting_name(key),
                            .otherwise = Variant{String{preset.certificates.subject.*key.member}}});
    }
    for (const LimitKey& key : limit_keys()) {
        if (key.is_setting) {
            settings.push_back(
                {.name = setting_name(key),
                 .otherwise = Variant{key.get(preset)},
                 .range = Range{static_cast<double>(key.least), static_cast<double>(key.most)},
                 .unit = std::string{key.unit}});
        }
    }
    for (Setting& each : settings) {
        if (each.name == "server.port") {
            each.range->low = preset.least_port;
        }
        each.is_security = is_security_setting(each.name);
    }
    return settings;
}

bool is_table_list(std::string_view name)
{
    constexpr std::array<std::string_view, 5> lists{"discovery.server", "endpoint", "plc.event",
                                                    "plc.program", "plc.variable"};
    return std::find(lists.begin(), lists.end(), name) != lists.end();
}

bool is_security_setting(std::string_view name)
{
    if (const LimitKey* const limit = find_limit(name)) {
        return limit->is_security;
    }
    return name == "endpoint" || name.starts_with("certificates.") || name.starts_with("users.") ||
           name.starts_with("limits.certificates.") || name == "server.auditing" ||
           name == "discovery.allow_none";
}

std::span<const Rule> rules()
{
    static constexpr std::array all{
        Rule{"certificates.common_name", "manual W588, 3-2-4"},
        Rule{"discovery.interval_s", "Part 4, 5.5.5.1"},
        Rule{"discovery.server", "Part 4, 5.5.3"},
        Rule{"endpoint", "manual W588, 3-2-6 and 5-2-2"},
        Rule{"limits.certificates.*", "manual W588, 1-2-2"},
        Rule{"limits.login*", "Part 4, 5.7.3.1"},
        Rule{"limits.sessions", "manual W588, 1-2-2"},
        Rule{"limits.receive_buffer_size", "Part 6, 7.1.2.3"},
        Rule{"limits.send_buffer_size", "Part 6, 7.1.2.3"},
        Rule{"limits.subscriptions.max_publishing_interval_ms", "Part 4, 5.14.2.2"},
        Rule{"limits.subscriptions.min_publishing_interval_ms", "Part 4, 5.14.2.2"},
        Rule{"machine.execution_log*", "manual W588, 3-2-2"},
        Rule{"machine.use", "manual W588, 3-2-2"},
        Rule{"server.locales", "Part 3, 8.4"},
        Rule{"server.port", "manual W588, 3-2-2"},
        Rule{"users.anonymous", "manual W588, 3-2-6"},
        Rule{"users.authorities", "manual W588, 8-1"},
        Rule{"users.passwords.*", "manual W588, 3-2-6"},
    };
    return all;
}

bool is_live(std::string_view name)
{
    if (const LimitKey* const limit = find_limit(name)) {
        return limit->is_live;
    }
    return name == "endpoint" || name == "users.anonymous" || name == "server.name" ||
           name == "machine.mode" || name.starts_with("limits.subscriptions.sa") ||
           name == "limits.subscriptions.overload_percent";
}

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
