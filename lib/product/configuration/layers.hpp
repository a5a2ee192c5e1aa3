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

/// What says something of a configuration. The later ones count.
enum class Layer : std::uint8_t {
    BuiltIn,
    Preset, // or the limits for a size of memory
    File,
    Project,
    Online, // changed by administrators
    CommandLine,
};
inline constexpr std::size_t layer_count = 6;

/// What counts more than the file; nothing of it by default.
struct Overlays {
    /// Has `config`, which is that of the file and of `changes`, say what a project of model mode
    /// says; `changes`, made online, count more. May throw ConfigError.
    std::function<void(ControllerConfig& config, const administration::SettingValues& changes)>
        project{};
    std::string project_preset{};
    // The command line's.
    std::string preset{};
    std::optional<std::uint16_t> port{};
    ProductNames names{};
};

/// Everything that a configuration is made of.
struct Layers {
    /// The file's text, and how messages call it.
    std::string text;
    std::string name;
    Overlays over{};
    administration::SettingValues changes{};
    /// Of `changes`; for people only.
    administration::SettingAuthors authors{};
};

struct Merged {
    ControllerConfig config;
    /// Of each setting.
    administration::SettingValues values;
};

/// The configuration that is in force as far as all layers up to `last` say. `sources` has the
/// files that it names. Throws ConfigError.
[[nodiscard]] Merged merge(const Layers& layers, std::span<const administration::Setting> settings,
                           SourceFiles& sources, Layer last = Layer::CommandLine);
/// The file's with the preset that counts instead of its own, but for one that was set online.
[[nodiscard]] toml::table with_preset(toml::table file, const Overlays& over);

/// What a layer says of a setting.
struct Saying {
    Layer layer;
    /// "nj501 (controller.toml:2)", "controller.toml:12"; empty: there is no more to say.
    std::string where;
    /// What is in force as far as the layers up to this one say. Null: they alone are no
    /// configuration.
    Variant value;
};

/// Where the values of settings come from.
class Provenance {
public:
    /// Throws a ConfigError if all layers together are no configuration. `sources` has the files
    /// that it names.
    Provenance(Layers layers, std::vector<administration::Setting> settings, SourceFiles& sources);

    [[nodiscard]] const ControllerConfig& config() const { return config_; }
    [[nodiscard]] std::span<const administration::Setting> settings() const { return settings_; }
    /// Returns who changed each setting online, and when.
    [[nodiscard]] const administration::SettingAuthors& authors() const { return layers_.authors; }
    /// The layers that say something of the setting. The first is the built-in one, the last is
    /// what counts.
    [[nodiscard]] std::vector<Saying> sayings(const administration::Setting& setting) const;
    /// The place of a key in the file, "controller.toml:12"; empty: it is not there.
    [[nodiscard]] std::string place(std::string_view key) const;

private:
    [[nodiscard]] std::vector<Saying>
    sayings_of_preset(const administration::Setting& setting) const;
    /// Where the layer says it; nothing if it does not.
    [[nodiscard]] std::optional<std::string> where(Layer layer, const std::string& name) const;
    [[nodiscard]] Variant value(Layer layer, const std::string& name) const;

    Layers layers_;
    toml::table file_;
    std::vector<administration::Setting> settings_;
    ControllerConfig config_;
    /// By layer; nothing where it is no configuration yet.
    std::array<std::optional<administration::SettingValues>, layer_count> values_;
};

} // namespace busbar::product
