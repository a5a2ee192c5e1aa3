#include "settings.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <busbar/administration/managed_certificates.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>

#include "product/store/received_program.hpp"
#include "product/store/taken_over.hpp"
#include "setting_keys.hpp"

namespace busbar::product {

namespace {

using administration::Setting;
using administration::SettingValues;

/// True if there is an encrypted endpoint, which administration requires.
bool is_encrypted(const ControllerConfig& config)
{
    const auto& endpoints = config.server.endpoints;
    return std::any_of(endpoints.begin(), endpoints.end(), [](const server::EndpointConfig& each) {
        return each.security.mode == MessageSecurityMode::SignAndEncrypt;
    });
}

bool is_in_run(const MachineConfig& machine)
{
    return machine.program != nullptr && machine.mode == controller::MachineMode::Run;
}

/// Describes the program that was sent, for people.
std::string received_text(Storage& folder)
{
    if (const auto bytes =
            read_file(folder, ReceivedProgram::file_name, ReceivedProgram::max_size)) {
        const std::string_view document{reinterpret_cast<const char*>(bytes->data()),
                                        bytes->size()};
        if (const auto sent = read_received(document, {})) {
            return "the program " + printable(sent->name) + " that " + printable(sent->user) +
                   " sent";
        }
    }
    return "a program that was sent, and cannot be read";
}

} // namespace

std::string name_of_file(const std::string& path)
{
    return path.empty() ? "built-in" : path;
}

Settings::Settings(const std::string& path, Overlays overlays, SourceFiles sources)
    : path_{path}, overlays_{std::move(overlays)}, sources_{std::move(sources)}, name_{name_of_file(
                                                                                     path)},
      text_{read_config_text(path, sources_)}, folder_{certificate_folder(
                                                   parse_table(text_, name_))},
      list_{files_, file_name,
            controller_settings(with_preset(parse_table(text_, name_), overlays_))}
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

Settings::Version Settings::version(const std::string& text, SourceFiles sources,
                                    const SettingValues& changes) const
{
    Version version{{}, std::move(sources)};
    version.merged = merge({text, name_, overlays_, changes}, list_.settings(), version.sources);
    return version;
}

Variant Settings::file_value(std::string_view name) const
{
    const Setting* const setting = list_.find(name);
    const Variant value =
        setting != nullptr ? value_in(with_preset(parse_table(text_, name_), overlays_), *setting)
                           : Variant{};
    return value.is_null() && setting != nullptr ? setting->otherwise : value;
}

std::vector<std::string> Settings::overruled() const
{
    const toml::table table = with_preset(parse_table(text_, name_), overlays_);
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
    config_ = std::move(version.merged.config);
    const SettingValues before = std::exchange(values_, std::move(version.merged.values));
    sources_ = std::move(version.sources);
    checked_.reset();
    if (running_.apply) {
        running_.apply(config_);
    }
    const bool is_secured_otherwise =
        std::ranges::any_of(list_.settings(), [&](const Setting& each) {
            const auto value = before.find(each.name);
            return each.is_security && value != before.end() &&
                   value->second != values_.at(each.name);
        });
    if (is_secured_otherwise && running_.security_changed) {
        running_.security_changed();
    }
}

void Settings::read_again(FunctionRef<void(const ControllerConfig&)> check)
{
    SourceFiles sources = sources_.again();
    std::string text = read_config_text(path_, sources);
    Version all = version(text, std::move(sources), list_.changes());
    if (is_in_run(config_.machine) && is_in_run(all.merged.config.machine)) {
        auto may_change = check_file_in_run(parse_table(text_, name_), parse_table(text, name_));
        if (!may_change) {
            may_change.error().where = name_ + ": " + may_change.error().where;
        }
        expect(may_change);
    }
    check(all.merged.config);
    if (running_.check) {
        expect(running_.check(all.merged.config));
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
    checked_.reset();
    try {
        Checked all{changes, version(text_, sources_, changes)};
        if (is_in_run(config_.machine)) {
            if (auto checked = check_in_run(values_, all.version.merged.values); !checked) {
                return checked;
            }
        }
        auto checked = check_version(all.version);
        if (checked) {
            checked_ = std::move(all);
        }
        return checked;
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

SettingValues Settings::values_on_disk() const
{
    SourceFiles sources = sources_.again();
    const std::string text = read_config_text(path_, sources);
    return version(text, std::move(sources), {}).merged.values;
}

Configured<void> Settings::check_restored(const SettingValues& changes, SourceFiles sources) const
{
    try {
        return check_version(version(text_, std::move(sources), changes));
    } catch (const ConfigError& error) {
        return Unexpected{error.problem()};
    }
}

Configured<void> Settings::check_version(const Version& all) const
{
    if (is_encrypted(config_) && !is_encrypted(all.merged.config)) {
        return misconfigured("endpoint",
                             "found none with the mode SignAndEncrypt; administration needs one",
                             status::Bad_InvalidArgument);
    }
    return running_.check ? running_.check(all.merged.config) : Configured<void>{};
}

void Settings::apply(const SettingValues& changes)
{
    auto checked = std::exchange(checked_, {});
    is_applying_ = true;
    const busbar::detail::Undo applied{[this] { is_applying_ = false; }};
    take(checked && checked->changes == changes ? std::move(checked->version)
                                                : version(text_, sources_, changes));
}

std::vector<std::string> forget_changes(const std::string& path)
{
    std::vector<std::string> forgotten;
    SourceFiles sources; // without the program, which may be the damaged file
    const std::string place =
        certificate_folder(parse_table(read_config_text(path, sources), name_of_file(path)));
    if (std::error_code ignored; !std::filesystem::exists(place, ignored)) {
        return forgotten;
    }
    storage::FolderStorage folder{place};
    const auto is_there = [&](std::string_view file) {
        const auto entry = folder.entry(file);
        return entry || entry.error() != StorageError::NotFound;
    };
    if (is_there(Settings::file_name)) {
        expect(administration::SettingList{folder, Settings::file_name, {}}.forget());
        forgotten.emplace_back("the settings that were changed online");
    }
    if (is_there(ReceivedProgram::file_name)) {
        std::string program = received_text(folder);
        expect(keep_received(folder, std::nullopt));
        forgotten.push_back(std::move(program));
    }
    TakenOverFiles last{folder};
    last.forget_settings();
    try {
        const Settings without{path};
    } catch (const ConfigError&) {
        return forgotten; // the controller cannot start without the program that it ran with last
    }
    expect(last.forget_file(folder.place(ReceivedProgram::file_name)));
    return forgotten;
}

} // namespace busbar::product
