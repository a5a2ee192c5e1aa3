#include "presets.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include <busbar/controller/machine_types.hpp>
#include <busbar/controller/publishing_limits.hpp>
#include <busbar/crypto/store_limits.hpp>
#include <busbar/server/password_rules.hpp>
#include <busbar/server/product_limits.hpp>

#include "core/json_writer.hpp"
#include "limit_keys.hpp"
#include "setting_keys.hpp"

namespace busbar::product {

namespace {

void take_nj501(ControllerConfig& config)
{
    config.server.limits = server::nj501_limits();
    config.certificates.limits = crypto::nj501_store_limits();
    config.certificates.subject = nj501_subject();
    config.users.password_rules = server::nj501_password_rules();
    config.machine.publishing = controller::nj501_publishing();
    config.machine.types = controller::nj501_types();
    config.machine.has_plcopen = true; // W588, 1-2-2
    config.least_port = 1'025;         // W588, 3-2-2
}

void take_nx102(ControllerConfig& config)
{
    take_nj501(config);
    config.server.limits = server::nx102_limits();
    config.certificates.limits = crypto::nx102_store_limits();
    config.machine.publishing = controller::nx102_publishing();
    config.machine.types = controller::nx102_types();
}

void take_rd81opc96(ControllerConfig& config)
{
    config.server.limits = server::rd81opc96_limits();
    config.certificates.limits = crypto::rd81opc96_store_limits();
    config.users.password_rules = server::rd81opc96_password_rules();
    config.machine.types = {.elementary = controller::ElementaryTypes::BuiltIn};
    config.machine.has_plcopen = false;
}

constexpr Departure nj501_departures[] = {
    {"machine.use", "false", "3-2-2",
     "a controller that opens no port cannot be set up over the network; use = false in [machine] "
     "is the manual's"},
    {"users.anonymous", "\"write\"", "3-2-6",
     "every client on the network could write every variable"},
    {"endpoint",
     "None, and Basic128Rsa15, Basic256 and Basic256Sha256 with Sign and SignAndEncrypt", "3-2-6",
     "None protects nothing, as the manual says itself; Basic128Rsa15 and Basic256 need SHA-1 and "
     "are deprecated (Part 7); [[endpoint]] can name each of them"},
    {"users.account", "every user reads and writes all variables", "5-1-2",
     "a user who is added online has the rights of his roles: role grant NAME Operator, or role "
     "grant Operator --everyone"},
};

constexpr std::array presets{Preset{"nj501", &take_nj501, nj501_departures},
                             Preset{"nx102", &take_nx102, nj501_departures},
                             Preset{"rd81opc96", &take_rd81opc96, {}}};

/// A figure without a key, and so without a row in limit_keys(), with its place among the figures
/// there.
struct OtherFigure {
    int place;
    std::string_view name;
    std::optional<std::uint64_t> (*get)(const ControllerConfig& config);
};

template <auto Member>
std::optional<std::uint64_t> published(const ControllerConfig& config)
{
    return config.machine.publishing.*Member;
}

using Publishing = controller::PublishingLimits;
constexpr std::array other_figures{
    OtherFigure{27, "reserved_names",
                [](const ControllerConfig& config) -> std::optional<std::uint64_t> {
                    return config.users.password_rules.reserved_names.size();
                }},
    OtherFigure{28, "published_variables", &published<&Publishing::max_variables>},
    OtherFigure{29, "published_values", &published<&Publishing::max_values>},
    OtherFigure{30, "published_data_types", &published<&Publishing::max_data_types>},
    OtherFigure{31, "variable_size", &published<&Publishing::max_size>},
    OtherFigure{32, "variable_elements", &published<&Publishing::max_elements>},
    OtherFigure{33, "structure_members", &published<&Publishing::max_members>},
    OtherFigure{34, "structure_levels", &published<&Publishing::max_levels>},
    OtherFigure{36, "issuer_certificates",
                [](const ControllerConfig& config) -> std::optional<std::uint64_t> {
                    return config.certificates.limits.max_certificates;
                }},
};

/// Collects the figures by their places.
std::map<int, std::pair<std::string_view, std::uint64_t>> figures_of(const ControllerConfig& config)
{
    std::map<int, std::pair<std::string_view, std::uint64_t>> figures;
    for (const LimitKey* const key : limits_in(&LimitKey::figure)) {
        figures.emplace(key->figure.place, std::pair{key->figure.name, key->get(config)});
    }
    for (const OtherFigure& other : other_figures) {
        if (const auto figure = other.get(config)) {
            figures.emplace(other.place, std::pair{other.name, *figure});
        }
    }
    return figures;
}

/// Adds the settings that differ from the manual, with their defaults here and there.
void add_departures(busbar::detail::JsonWriter& json, const Preset& preset)
{
    const auto settings = controller_settings(
        toml::table{{"limits", toml::table{{"preset", std::string{preset.name}}}}});
    json.name("departures");
    json.begin_list();
    for (const Departure& each : preset.departures) {
        const auto setting =
            std::ranges::find(settings, each.setting, &administration::Setting::name);
        json.begin_object();
        const auto add = [&](std::string_view name, std::string_view text) {
            json.name(name);
            json.string(text);
        };
        add("setting", each.setting);
        add("manual", each.manual);
        if (setting != settings.end()) {
            add("here", value_text(setting->otherwise));
        }
        add("section", each.section);
        add("reason", each.reason);
        json.end_object();
    }
    json.end_list();
}

} // namespace

const Preset* find_preset(std::string_view name)
{
    const auto* const found = std::ranges::find(presets, name, &Preset::name);
    return found == presets.end() ? nullptr : found;
}

std::string preset_json(const Preset& preset)
{
    ControllerConfig config;
    preset.take(config);
    busbar::detail::JsonWriter json;
    json.begin_object();
    json.name("preset");
    json.string(preset.name);
    for (const auto& [place, figure] : figures_of(config)) {
        json.name(figure.first);
        json.word(std::to_string(figure.second));
    }
    if (config.least_port != 0) {
        json.name("least_port");
        json.word(std::to_string(config.least_port));
    }
    if (!preset.departures.empty()) {
        add_departures(json, preset);
    }
    json.end_object();
    return json.take() + "\n";
}

int print_preset(const std::string& name)
{
    const Preset* const preset = find_preset(name);
    if (preset == nullptr) {
        std::fprintf(stderr, "busbar-controller: found the preset \"%s\", expected %.*s\n",
                     name.c_str(), static_cast<int>(preset_names.size()), preset_names.data());
        return 2;
    }
    std::fputs(preset_json(*preset).c_str(), stdout);
    return 0;
}

} // namespace busbar::product
