#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/administration/setting_list.hpp>
#include <busbar/product/configuration.hpp>

#include "config.hpp"
#include "toml.hpp"

namespace busbar::product {

/// The layers of a configuration; later ones override earlier ones.
enum class Layer : std::uint8_t {
    BuiltIn,
    Preset, // or the limits for a size of memory
    File,
    Project,
    Online, // changed by administrators
    CommandLine,
};
inline constexpr std::size_t layer_count = 6;

/// Settings that override the file; none by default.
struct Overlays {
    /// Applies a project of model mode to `config`, which consists of the file and of `changes`;
    /// these were made online and take precedence. May throw ConfigError.
    std::function<void(ControllerConfig& config, const administration::SettingValues& changes)>
        project{};
    std::string project_preset{};
    // from the command line
    std::string preset{};
    std::optional<std::uint16_t> port{};
    ProductNames names{};
};

/// All layers of a configuration.
struct Layers {
    /// The file's text, and its name in messages.
    std::string text;
    std::string name;
    Overlays over{};
    administration::SettingValues changes{};
    /// Authors of `changes`; for people only.
    administration::SettingAuthors authors{};
};

struct Merged {
    ControllerConfig config;
    /// The values of all settings.
    administration::SettingValues values;
};

/// Merges all layers up to `last` into a configuration. `sources` provides the files that it names.
/// Throws ConfigError.
[[nodiscard]] Merged merge(const Layers& layers, std::span<const administration::Setting> settings,
                           SourceFiles& sources, Layer last = Layer::CommandLine);
/// Puts the overriding preset into the file's table, unless a preset was set online.
[[nodiscard]] toml::table with_preset(toml::table file, const Overlays& over);

/// A layer's value of a setting.
struct Saying {
    Layer layer;
    /// "nj501 (controller.toml:2)", "controller.toml:12"; empty if there is nothing to add.
    std::string where;
    /// The value if only the layers up to this one are merged. Null if they are not a valid
    /// configuration.
    Variant value;
};

/// The origin of the values of settings.
class Provenance {
public:
    /// Throws a ConfigError if all layers together are not a valid configuration. `sources`
    /// provides the files that it names.
    Provenance(Layers layers, std::vector<administration::Setting> settings, SourceFiles& sources);

    [[nodiscard]] const ControllerConfig& config() const { return config_; }
    [[nodiscard]] std::span<const administration::Setting> settings() const { return settings_; }
    /// Returns the author and time of each online change.
    [[nodiscard]] const administration::SettingAuthors& authors() const { return layers_.authors; }
    /// The layers that set the value. The first is the built-in one, the last is in force.
    [[nodiscard]] std::vector<Saying> sayings(const administration::Setting& setting) const;
    /// Place of a key in the file, "controller.toml:12"; empty if it is not in the file.
    [[nodiscard]] std::string place(std::string_view key) const;

private:
    [[nodiscard]] std::vector<Saying>
    sayings_of_preset(const administration::Setting& setting) const;
    /// Place where the layer sets it; nothing if it does not.
    [[nodiscard]] std::optional<std::string> where(Layer layer, const std::string& name) const;
    [[nodiscard]] Variant value(Layer layer, const std::string& name) const;

    Layers layers_;
    toml::table file_;
    std::vector<administration::Setting> settings_;
    ControllerConfig config_;
    /// Values by layer; nothing for a layer that does not give a valid configuration yet.
    std::array<std::optional<administration::SettingValues>, layer_count> values_;
};

} // namespace busbar::product
