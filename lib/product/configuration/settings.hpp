#pragma once

#include <functional>
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

/// How messages call the file at `path`, which is empty for the built-in one.
[[nodiscard]] std::string name_of_file(const std::string& path);

/// The settings of a controller: what its file says, and over it what was changed online, which
/// lies in the folder of certificates. The file is read, never written.
///
/// A machine that is in RUN refuses to have some of them changed online (see
/// program_only_settings).
class Settings final : public administration::SettingOwner {
public:
    static constexpr const char* file_name = "settings.json";

    /// What puts a configuration in force, as far as that can be while the controller runs.
    struct Running {
        std::function<Configured<void>(const ControllerConfig& config)> check;
        std::function<void(const ControllerConfig& config)> apply;
        /// Called after apply() if a setting of the security profile is another one. May be empty.
        std::function<void()> security_changed{};
    };

    /// `path` is that of the file, empty for the built-in one. Throws ConfigError, also where what
    /// was changed does not fit the file any more.
    explicit Settings(const std::string& path, Overlays overlays = {}, SourceFiles sources = {});

    /// The configuration in force: the file's with what was changed, and complete. What was changed
    /// takes over no other text of a file that the configuration names.
    [[nodiscard]] const ControllerConfig& config() const { return config_; }
    /// The file's, as it was read last.
    [[nodiscard]] const std::string& text() const { return text_; }
    /// All of them, as they would be with these changes of what the file says.
    [[nodiscard]] administration::SettingValues
    all_values(const administration::SettingValues& changes) const
    {
        return version(text_, sources_, changes).merged.values;
    }
    /// All of them, as the file says them that lies there now. Throws ConfigError.
    [[nodiscard]] administration::SettingValues values_on_disk() const;
    /// As check(), of what another controller or an earlier time had, whatever the mode; with
    /// `sources` instead of sources().
    [[nodiscard]] Configured<void> check_restored(const administration::SettingValues& changes,
                                                  SourceFiles sources) const;
    /// What the file says of a setting, or else its default; null if there is none of the name.
    [[nodiscard]] Variant file_value(std::string_view name) const;
    /// The names of those that the file says otherwise than what was changed online, which counts.
    [[nodiscard]] std::vector<std::string> overruled() const;
    /// Those that config() is made of.
    [[nodiscard]] SourceFiles& sources() { return sources_; }
    [[nodiscard]] const SourceFiles& sources() const { return sources_; }
    /// They have these texts from now on, of which config() is not made anew.
    void use(SourceFiles sources) { sources_ = std::move(sources); }
    [[nodiscard]] administration::SettingList& list() { return list_; }
    [[nodiscard]] const administration::SettingList& list() const { return list_; }
    /// The folder of certificates, as everybody changes it; and what is behind the gate, for a
    /// restore.
    [[nodiscard]] StorageGate& files() { return files_; }
    [[nodiscard]] Storage& folder() { return folder_; }
    /// From now on what is changed is in force at once, where it can be.
    void run(Running running) { running_ = std::move(running); }
    /// The file again, under what was changed. `check` may throw. Throws a ConfigError and changes
    /// nothing, also if a machine that stays in RUN would get other users or endpoints.
    void read_again(FunctionRef<void(const ControllerConfig&)> check);

    [[nodiscard]] Variant value(const administration::Setting& setting) const override;
    [[nodiscard]] bool waits_for_restart(const administration::Setting& setting) const override;
    /// Whether any does.
    [[nodiscard]] bool waits_for_restart() const;
    [[nodiscard]] Configured<void> check(const administration::SettingValues& changes) override;
    void apply(const administration::SettingValues& changes) override;

private:
    struct Version {
        Merged merged;
        SourceFiles sources;
    };

    [[nodiscard]] Version version(const std::string& text, SourceFiles sources,
                                  const administration::SettingValues& changes) const;
    [[nodiscard]] Configured<void> check_version(const Version& all) const;
    void take(Version version);

    std::string path_;
    Overlays overlays_;
    SourceFiles sources_;
    /// How messages call the file.
    std::string name_;
    /// The file's.
    std::string text_;
    storage::FolderStorage folder_;
    StorageGate files_{folder_};
    administration::SettingList list_;
    ControllerConfig config_;
    administration::SettingValues values_;
    administration::SettingValues started_;
    Running running_;
};

/// Forgets what was changed online, readable or not: settings, and a program that was sent. Returns
/// what that was, in words. A copy of that program stays in TakenOverFiles if the files alone make
/// no controller. The controller must not run. Throws ConfigError; called again after one, or after
/// a power cut, it forgets the rest.
std::vector<std::string> forget_changes(const std::string& path);

} // namespace busbar::product
