#include "layers.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "limit_keys.hpp"
#include "sections.hpp"
#include "setting_keys.hpp"

namespace busbar::product {

namespace {

using administration::Setting;
using administration::SettingValues;

constexpr std::string_view preset_setting = "limits.preset";

Variant text_value(std::string_view text)
{
    return Variant{String{text}};
}

/// Converts to "no", "read" or "write".
Variant access_value(const std::optional<AccountAccess>& access)
{
    return text_value(!access ? "no" : *access == AccountAccess::Write ? "write" : "read");
}

/// Settings that are not numbers and that other layers besides the file set.
constexpr std::array<std::pair<std::string_view, Variant (*)(const ControllerConfig&)>, 6>
    other_values{{
        {"endpoint", [](const ControllerConfig& c) { return endpoint_value(c.server); }},
        {"server.address", [](const ControllerConfig& c) { return text_value(c.address); }},
        {"certificates.trust_all_clients",
         [](const ControllerConfig& c) { return Variant{c.certificates.trusts_all_clients}; }},
        {"discovery.url", [](const ControllerConfig& c) { return text_value(c.discovery.url); }},
        {"users.anonymous",
         [](const ControllerConfig& c) { return access_value(c.users.anonymous); }},
        {"users.certificates",
         [](const ControllerConfig& c) { return access_value(c.users.certified); }},
    }};

/// Settings that a project always sets (SH-082679, 9.7 to 9.11); it sets others only if they
/// differ.
constexpr std::array<std::string_view, 6> project_settings{
    "endpoint",      "server.address",      "server.port", "certificates.trust_all_clients",
    "discovery.url", "discovery.interval_s"};

void set_names(server::ServerConfig& server, const ProductNames& names)
{
    server.build.manufacturer_name = names.manufacturer;
    server.build.software_version = names.version;
    if (!names.product_uri.empty()) {
        server.product_uri = names.product_uri;
    }
}

/// Returns the value; limits and names that no key sets come from the preset.
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

void set_preset(toml::table& table, const std::string& preset)
{
    if (!preset.empty()) {
        table.insert("limits", toml::table{});
        if (toml::table* const limits = table["limits"].as_table()) {
            limits->insert_or_assign("preset", preset);
        }
    }
}

/// Returns the preset that replaces the file's.
std::string preset_of(const Layers& layers, const toml::table& file)
{
    if (!layers.over.preset.empty()) {
        return layers.over.preset;
    }
    const auto changed = layers.changes.find(preset_setting);
    if (const auto* const text =
            changed != layers.changes.end() ? changed->second.get_if<String>() : nullptr) {
        return text->str();
    }
    return layers.over.project_preset.empty() ? file.at_path(preset_setting).value_or(std::string{})
                                              : layers.over.project_preset;
}

/// Returns the keys of the file that determine limits for a size of memory.
toml::table memory_of(const toml::table& file)
{
    toml::table table;
    for (const auto& [section, key] : {std::pair{"limits", "memory"}, {"users", "password_hash"}}) {
        if (const toml::node* const node = file[section][key].node()) {
            table.insert_or_assign(section, toml::table{{key, *node}});
        }
    }
    return table;
}

toml::table table_up_to(const Layers& layers, Layer last)
{
    toml::table table; // do not copy nodes: copies lose their lines
    if (last >= Layer::Preset) {
        toml::table file = parse_table(layers.text, layers.name);
        const std::string preset = preset_of(layers, file);
        table = last >= Layer::File ? std::move(file) : memory_of(file);
        set_preset(table, preset);
    }
    if (last >= Layer::Online) {
        overlay(table, layers.changes);
        set_preset(table, layers.over.preset);
    }
    return table;
}

} // namespace

toml::table with_preset(toml::table file, const Overlays& over)
{
    set_preset(file, over.preset.empty() ? over.project_preset : over.preset);
    return file;
}

Merged merge(const Layers& layers, std::span<const Setting> settings, SourceFiles& sources,
             Layer last)
{
    const toml::table table = table_up_to(layers, last);
    Merged merged{config_of(table, layers.name, sources), {}};
    set_names(merged.config.server, layers.over.names);
    if (last >= Layer::Project && layers.over.project) {
        layers.over.project(merged.config,
                            last >= Layer::Online ? layers.changes : SettingValues{});
    }
    if (last >= Layer::CommandLine) {
        merged.config.port = layers.over.port.value_or(merged.config.port);
    }
    for (const Setting& setting : settings) {
        merged.values.emplace(setting.name, value_of(table, merged.config, setting));
    }
    return merged;
}

Provenance::Provenance(Layers layers, std::vector<Setting> settings, SourceFiles& sources)
    : layers_{std::move(layers)}, file_{parse_table(layers_.text, layers_.name)}, settings_{
                                                                                      std::move(
                                                                                          settings)}
{
    for (std::size_t i = 0; i < layer_count; ++i) {
        const auto layer = static_cast<Layer>(i);
        try {
            Merged merged = merge(layers_, settings_, sources, layer);
            values_[i] = std::move(merged.values);
            config_ = std::move(merged.config);
        } catch (const ConfigError&) {
            if (layer == Layer::CommandLine) {
                throw;
            }
        }
    }
}

std::string Provenance::place(std::string_view key) const
{
    const toml::node* node = file_.at_path(key).node();
    if (node == nullptr) {
        return {};
    }
    if (const toml::array* const array = node->as_array();
        array != nullptr && !array->empty() && array->front().is_table()) {
        node = &array->front(); // [[key]]
    }
    return layers_.name + ":" + std::to_string(node->source().begin.line);
}

Variant Provenance::value(Layer layer, const std::string& name) const
{
    const auto& values = values_[static_cast<std::size_t>(layer)];
    return values ? values->at(name) : Variant{};
}

std::optional<std::string> Provenance::where(Layer layer, const std::string& name) const
{
    const auto given = [](std::string place) {
        return place.empty() ? std::nullopt : std::optional{std::move(place)};
    };
    switch (layer) {
    case Layer::File:
        return given(name == "endpoint" && place(name).empty() ? place("security") : place(name));
    case Layer::Project:
        return layers_.over.project &&
                       std::ranges::find(project_settings, name) != project_settings.end()
                   ? std::optional{std::string{}}
                   : std::nullopt;
    case Layer::Online:
        return layers_.changes.contains(name) ? std::optional{std::string{}} : std::nullopt;
    case Layer::CommandLine:
        return name == "server.port" && layers_.over.port ? std::optional{std::string{"--port"}}
                                                          : std::nullopt;
    default:
        return std::nullopt;
    }
}

std::vector<Saying> Provenance::sayings_of_preset(const Setting& setting) const
{
    std::vector<Saying> all{{Layer::BuiltIn, {}, setting.otherwise}};
    all.front().value = text_value("");
    const auto add = [&all](Layer layer, std::string where, Variant value) {
        Saying saying{.layer = layer, .where = std::move(where), .value = std::move(value)};
        all.push_back(std::move(saying));
    };
    if (const auto text = file_.at_path(preset_setting).value<std::string>()) {
        add(Layer::File, place(preset_setting), text_value(*text));
    }
    if (!layers_.over.project_preset.empty()) {
        add(Layer::Project, {}, text_value(layers_.over.project_preset));
    }
    if (const auto changed = layers_.changes.find(setting.name); changed != layers_.changes.end()) {
        add(Layer::Online, {}, changed->second);
    }
    if (!layers_.over.preset.empty()) {
        add(Layer::CommandLine, "--preset", text_value(layers_.over.preset));
    }
    return all;
}

std::vector<Saying> Provenance::sayings(const Setting& setting) const
{
    if (setting.name == preset_setting) {
        return sayings_of_preset(setting);
    }
    const std::string preset = preset_of(layers_, file_);
    std::vector<Saying> all{{Layer::BuiltIn, {}, value(Layer::BuiltIn, setting.name)}};
    for (std::size_t i = 1; i < layer_count; ++i) {
        const auto layer = static_cast<Layer>(i);
        Variant now = value(layer, setting.name);
        if (auto place = where(layer, setting.name)) {
            all.push_back({layer, *std::move(place), std::move(now)});
        } else if (!now.is_null() && !all.back().value.is_null() && now != all.back().value) {
            // The layer sets another key that this setting follows.
            const std::string by = layer != Layer::Preset ? std::string{}
                                   : preset.empty()       ? "limits.memory"
                                                          : preset;
            all.push_back({layer, by, std::move(now)});
        }
    }
    return all;
}

} // namespace busbar::product
