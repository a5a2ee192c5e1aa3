#include "settings.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include <busbar/administration/managed_certificates.hpp>

#include "limit_keys.hpp"
#include "mode_guard.hpp"
#include "product/store/received_program.hpp"
#include "product/store/taken_over.hpp"
#include "setting_keys.hpp"
#include "setting_overlay.hpp"

namespace busbar::product {

namespace {

using administration::Setting;
using administration::SettingValues;

std::string name_of_file(const std::string& path)
{
    return path.empty() ? "built-in" : path;
}

Variant text_value(const std::string& text)
{
    return Variant{String{text}};
}

/// Those that are no numbers and that more than the file says (see Reading).
constexpr std::array<std::pair<std::string_view, Variant (*)(const ControllerConfig&)>, 4>
    other_values{{
        {"endpoint", [](const ControllerConfig& c) { return endpoint_value(c.server); }},
        {"server.address", [](const ControllerConfig& c) { return text_value(c.address); }},
        {"certificates.trust_all_clients",
         [](const ControllerConfig& c) { return Variant{c.certificates.trusts_all_clients}; }},
        {"discovery.url", [](const ControllerConfig& c) { return text_value(c.discovery.url); }},
    }};

/// Limits and names that no key sets are those of the preset.
Variant value_of(const toml::table& table, const ControllerConfig& config, const Setting& setting)
{
    if (const LimitKey* const limit = find_limit(setting.name)) {
        return Variant{limit->get(config)};
    }
    for (const SubjectKey& key : subject_keys) {
        if (setting.name == setting_name(key)) {
            return Variant{String{config.certificates.subject.*key.member}};
        }
    }
    for (const auto& [name, value] : other_values) {
        if (setting.name == name) {
            return value(config);
        }
    }
    Variant value = value_in(table, setting);
    return value.is_null() ? setting.otherwise : value;
}

/// Administration is over encrypted connections only.
bool is_encrypted(const ControllerConfig& config)
{
    const auto& endpoints = config.server.endpoints;
    return std::any_of(endpoints.begin(), endpoints.end(), [](const server::EndpointConfig& each) {
        return each.security.mode == MessageSecurityMode::SignAndEncrypt;
    });
}

} // namespace

Settings::Settings(const std::string& path, std::string preset, Completion completion,
                   SourceFiles sources)
    : path_{path}, preset_{std::move(preset)}, completion_{std::move(completion)},
      sources_{std::move(sources)}, name_{name_of_file(path)}, text_{read_config_text(path,
                                                                                      sources_)},
      folder_{certificate_folder(table_of(text_))}, list_{files_, file_name,
                                                          controller_settings(table_of(text_))}
{
    expect(administration::finish_changes(folder_));
    sources_.receive_at(folder_.place(ReceivedProgram::file_name));
    expect(list_.load());
    try {
        take(version(text_, sources_, list_.changes()));
    } catch (const ConfigError& error) {
        if (list_.changes().empty()) {
            throw;
        }
        throw ConfigError{error.what(), "with what was changed online, which --forget-changes "
                                        "drops"};
    }
    started_ = values_;
}

toml::table Settings::table_of(const std::string& text) const
{
    toml::table table = parse_table(text, name_);
    if (!preset_.empty()) {
        table.insert("limits", toml::table{});
        if (toml::table* const entries = table["limits"].as_table()) {
            entries->insert_or_assign("preset", preset_);
        }
    }
    return table;
}

Settings::Version Settings::version(const std::string& text, SourceFiles sources,
                                    const SettingValues& changes) const
{
    toml::table table = table_of(text);
    overlay(table, changes);
    Version version{{}, {}, std::move(sources)};
    version.config = config_of(table, name_, version.sources);
    if (completion_) {
        completion_(version.config, changes);
    }
    for (const Setting& setting : list_.settings()) {
        version.values.emplace(setting.name, value_of(table, version.config, setting));
    }
    return version;
}

Variant Settings::file_value(std::string_view name) const
{
    const Setting* const setting = list_.find(name);
    const Variant value = setting != nullptr ? value_in(table_of(text_), *setting) : Variant{};
    return value.is_null() && setting != nullptr ? setting->otherwise : value;
}

std::vector<std::string> Settings::overruled() const
{
    const toml::table table = table_of(text_);
    std::vector<std::string> names;
    for (const auto& [name, value] : list_.changes()) {
        const Setting* const setting = list_.find(name);
        const Variant of_file = setting != nullptr ? value_in(table, *setting) : Variant{};
        if (!of_file.is_null() && !(of_file == value)) {
            names.push_back(name);
        }
    }
    return names;
}

void Settings::take(Version version)
{
    config_ = std::move(version.config);
    values_ = std::move(version.values);
    sources_ = std::move(version.sources);
    if (running_.apply) {
        running_.apply(config_);
    }
}

void Settings::read_again(FunctionRef<void(const ControllerConfig&)> check)
{
    SourceFiles sources;
    sources.receive_at(sources_.received_place());
    std::string text = read_config_text(path_, sources);
    Version all = version(text, std::move(sources), list_.changes());
    check(all.config);
    if (running_.check) {
        expect(running_.check(all.config));
    }
    text_ = std::move(text);
    take(std::move(all));
}

Variant Settings::value(const Setting& setting) const
{
    return values_.at(setting.name);
}

bool Settings::waits_for_restart(const Setting& setting) const
{
    return !is_live(setting.name) && !(values_.at(setting.name) == started_.at(setting.name));
}

bool Settings::waits_for_restart() const
{
    return std::ranges::any_of(list_.settings(),
                               [this](const Setting& each) { return waits_for_restart(each); });
}

Configured<void> Settings::check(const SettingValues& changes)
{
    try {
        const Version all = version(text_, sources_, changes);
        const MachineConfig& machine = config_.machine;
        if (machine.program != nullptr && machine.mode == controller::MachineMode::Run) {
            if (auto checked = check_in_run(values_, all.values); !checked) {
                return checked;
            }
        }
        if (is_encrypted(config_) && !is_encrypted(all.config)) {
            return misconfigured(
                "endpoint", "found none with the mode SignAndEncrypt; administration needs one",
                status::Bad_InvalidArgument);
        }
        return running_.check ? running_.check(all.config) : Configured<void>{};
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

void Settings::apply(const SettingValues& changes)
{
    take(version(text_, sources_, changes));
}

void forget_changes(const std::string& path)
{
    const std::string place = read_config_or_default(path).certificates.folder;
    if (std::error_code ignored; !std::filesystem::exists(place, ignored)) {
        return;
    }
    storage::FolderStorage folder{place};
    expect(administration::SettingList{folder, Settings::file_name, {}}.forget());
    TakenOverFiles{folder}.forget_settings();
}

} // namespace busbar::product
