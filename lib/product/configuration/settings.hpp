#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/administration/setting_list.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/storage_gate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "config.hpp"
#include "layers.hpp"

namespace busbar::product {

/// The name of the file at `path` in messages; `path` is empty for the built-in one.
[[nodiscard]] std::string name_of_file(const std::string& path);

/// The settings of a controller: those of its file, overridden by online changes, which are stored
/// in the folder of certificates. The file is read, never written.
///
/// A machine in RUN refuses online changes of some settings (see program_only_settings).
class Settings final : public administration::SettingOwner {
public:
    static constexpr const char* file_name = "settings.json";

    /// Applies a configuration, as far as possible while the controller runs.
    struct Running {
        std::function<Configured<void>(const ControllerConfig& config)> check;
        std::function<void(const ControllerConfig& config)> apply;
        /// Called after apply() if a setting of the security profile changed. May be empty.
        std::function<void()> security_changed{};
    };

    /// `path` is that of the file, empty for the built-in one. Throws ConfigError, also if online
    /// changes are no longer valid with the file.
    explicit Settings(const std::string& path, Overlays overlays = {}, SourceFiles sources = {});

    /// The configuration in force: the file with online changes, and complete. Files that the
    /// configuration names are not read again for online changes.
    [[nodiscard]] const ControllerConfig& config() const { return config_; }
    /// The file's text as last read.
    [[nodiscard]] const std::string& text() const { return text_; }
    /// The values of all settings if these were the changes to the file.
    [[nodiscard]] administration::SettingValues
    all_values(const administration::SettingValues& changes) const
    {
        return version(text_, sources_, changes).merged.values;
    }
    /// The values of all settings in the present file. Throws ConfigError.
    [[nodiscard]] administration::SettingValues values_on_disk() const;
    /// Like check() for changes from another controller or an earlier time, in any mode, and with
    /// `sources` instead of sources().
    [[nodiscard]] Configured<void> check_restored(const administration::SettingValues& changes,
                                                  SourceFiles sources) const;
    /// The file's value of a setting, or its default; null for an unknown name.
    [[nodiscard]] Variant file_value(std::string_view name) const;
    /// Names of settings in the file that online changes override with another value.
    [[nodiscard]] std::vector<std::string> overruled() const;
    /// The files that config() was made from.
    [[nodiscard]] SourceFiles& sources() { return sources_; }
    [[nodiscard]] const SourceFiles& sources() const { return sources_; }
    /// Replaces the files, without making config() again.
    void use(SourceFiles sources)
    {
        sources_ = std::move(sources);
        checked_.reset();
    }
    [[nodiscard]] administration::SettingList& list() { return list_; }
    [[nodiscard]] const administration::SettingList& list() const { return list_; }
    /// The folder of certificates for ordinary changes, and the storage below the gate for a
    /// restore.
    [[nodiscard]] StorageGate& files() { return files_; }
    [[nodiscard]] Storage& folder() { return folder_; }
    /// Applies changes at once from now on, where possible.
    void run(Running running) { running_ = std::move(running); }
    /// Reads the file again, below the online changes. `check` may throw. Throws a ConfigError and
    /// changes nothing, also if a machine that stays in RUN would get other users or endpoints.
    void read_again(FunctionRef<void(const ControllerConfig&)> check);

    [[nodiscard]] Variant value(const administration::Setting& setting) const override;
    [[nodiscard]] bool waits_for_restart(const administration::Setting& setting) const override;
    /// Tells whether any setting waits for a restart.
    [[nodiscard]] bool waits_for_restart() const;
    [[nodiscard]] Configured<void> check(const administration::SettingValues& changes) override;
    void apply(const administration::SettingValues& changes) override;
    /// True while apply() runs: what changes then was changed online.
    [[nodiscard]] bool is_applying() const { return is_applying_; }

private:
    struct Version {
        Merged merged;
        SourceFiles sources;
    };

    struct Checked {
        administration::SettingValues changes;
        Version version;
    };

    [[nodiscard]] Version version(const std::string& text, SourceFiles sources,
                                  const administration::SettingValues& changes) const;
    [[nodiscard]] Configured<void> check_version(const Version& all) const;
    void take(Version version);

    std::string path_;
    Overlays overlays_;
    SourceFiles sources_;
    /// The name of the file in messages.
    std::string name_;
    /// The file's text.
    std::string text_;
    storage::FolderStorage folder_;
    StorageGate files_{folder_};
    administration::SettingList list_;
    ControllerConfig config_;
    administration::SettingValues values_;
    administration::SettingValues started_;
    Running running_;
    /// The result of the last check(): apply(), which comes after the changes were stored, must not
    /// fail for lack of memory, and reads nothing again.
    std::optional<Checked> checked_;
    bool is_applying_{false};
};

/// Removes online changes, readable or not: settings, and a program that was sent. Returns what it
/// removed, in words. A copy of that program stays in TakenOverFiles if the files alone are not a
/// valid configuration. The controller must not run. Throws ConfigError; if called again after
/// that, or after a power cut, it removes the rest.
std::vector<std::string> forget_changes(const std::string& path);

} // namespace busbar::product
