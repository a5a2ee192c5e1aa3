#include "describe.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/text.hpp>
#include <busbar/net/device_driver.hpp>

namespace busbar::product {

namespace {

using backend::Device;
using backend::DeviceState;

TimePoint present()
{
    return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

double milliseconds_since(TimePoint begin)
{
    return std::chrono::duration<double, std::milli>(present() - begin).count();
}

/// A backend and what its PLC answered.
struct Asked {
    Asked(const BackendConfig& c, LogSink& log)
        : config{c}, device{c.device, c.make_protocol(), log}
    {
    }

    /// Not connected yet. A second attempt may be in another frame; further ones would only have a
    /// PLC count wrong passwords.
    [[nodiscard]] bool is_waiting() const
    {
        const bool has_failed = device.state() == DeviceState::Waiting &&
                                (device.counters().attempts >= 2 || device.is_denied());
        return !batch && !result && !has_failed;
    }
    [[nodiscard]] std::optional<Variant> value_of(std::size_t variable) const
    {
        const backend::PlanValue& read = result->values[variable];
        if (read.status.is_bad()) {
            return std::nullopt;
        }
        auto value = backend::read_point(config.variables[variable].point, result->words_of(read));
        return value ? std::optional{*std::move(value)} : std::nullopt;
    }
    [[nodiscard]] StatusCode status_of(std::size_t variable) const
    {
        const backend::PlanValue& read = result->values[variable];
        if (read.status.is_bad()) {
            return read.status;
        }
        const auto value =
            backend::read_point(config.variables[variable].point, result->words_of(read));
        return value ? read.status : value.error();
    }
    /// Returns what the PLC says of a variable that it refuses; empty if it says nothing.
    [[nodiscard]] std::string reason_of(std::size_t variable) const
    {
        const std::uint16_t code = result->values[variable].code;
        return code == 0 ? std::string{} : device.protocol().text_of(code);
    }
    [[nodiscard]] std::size_t refused() const
    {
        std::size_t count = 0;
        for (std::size_t i = 0; i < config.variables.size(); ++i) {
            count += status_of(i).is_bad() ? 1U : 0U;
        }
        return count;
    }

    /// RUN or STOP, if the PLC says it; it follows the variables in the result.
    [[nodiscard]] backend::DeviceMode mode() const
    {
        const bool is_there = result->values.size() > config.variables.size() &&
                              result->values.back().status.is_good();
        return is_there ? device.protocol().mode_of(result->words_of(result->values.back()))
                        : backend::DeviceMode::Unknown;
    }
    /// ", R08CPU (family iq-r), in RUN": what is known of the PLC.
    [[nodiscard]] std::string description() const
    {
        std::string text = printable(device.identity_text());
        const std::string& family = device.identity().family;
        if (!family.empty()) {
            text += (text.empty() ? "family " : " (family ") + family + (text.empty() ? "" : ")");
        }
        if (mode() != backend::DeviceMode::Unknown) {
            text += (text.empty() ? "in " : ", in ") + std::string{name_of(mode())};
        }
        return text.empty() ? text : ", " + text;
    }

    const BackendConfig& config;
    Device device;
    TimePoint begun{};
    double read_ms{0};
    std::optional<std::uint64_t> batch;
    std::optional<backend::PlanResult> result;
};

/// Asks for everything once it can, and keeps the answer.
void look(Asked& asked)
{
    if (!asked.batch && !asked.result && asked.device.state() == DeviceState::Online) {
        std::vector<backend::PlanAddress> addresses;
        for (const BackendVariable& variable : asked.config.variables) {
            addresses.push_back(variable.point.address);
        }
        if (const auto place = asked.device.protocol().mode_place()) {
            addresses.push_back(*place);
        }
        asked.begun = present();
        if (const auto batch = asked.device.read(addresses, asked.begun)) {
            asked.batch = *batch;
        }
    }
    if (asked.batch && !asked.result) {
        asked.result = asked.device.next_result();
        asked.read_ms = milliseconds_since(asked.begun);
    }
}

std::string place_of(const BackendConfig& config)
{
    return config.device.host + ":" + std::to_string(config.device.port);
}

/// "Bad_ConfigurationError: 4031: a device is outside the range ...".
std::string status_text(const Asked& asked, std::size_t variable)
{
    const std::string reason = asked.reason_of(variable);
    return std::string{name(asked.status_of(variable))} + (reason.empty() ? "" : ": " + reason);
}

void print_text(const Asked& asked)
{
    const BackendConfig& config = asked.config;
    if (!asked.result) {
        std::printf("%s: %s at %s is not reached: %s\n", config.name.c_str(),
                    config.protocol_name(), place_of(config).c_str(),
                    asked.device.trouble().c_str());
        return;
    }
    std::printf("%s: %s at %s%s: %zu of %zu variables read in %.1f ms by %llu requests\n",
                config.name.c_str(), config.protocol_name(), place_of(config).c_str(),
                asked.description().c_str(), config.variables.size() - asked.refused(),
                config.variables.size(), asked.read_ms,
                static_cast<unsigned long long>(asked.device.plan_counters().requests));
    for (std::size_t i = 0; i < config.variables.size(); ++i) {
        const BackendVariable& variable = config.variables[i];
        const auto value = asked.value_of(i);
        std::printf("  %-9s %s  %s  %s\n", value ? "read" : "not read", variable.name.c_str(),
                    variable.at.c_str(),
                    value ? printable(binary::to_text(*value)).c_str()
                          : status_text(asked, i).c_str());
    }
}

void write_json(detail::JsonWriter& json, const Asked& asked)
{
    const BackendConfig& config = asked.config;
    json.begin_object();
    add_member(json, "backend", config.name);
    add_member(json, "protocol", config.protocol_name());
    add_member(json, "address", place_of(config));
    if (!asked.result) {
        add_member(json, "trouble", asked.device.trouble());
        json.end_object();
        return;
    }
    add_member(json, "identity", asked.device.identity_text());
    add_member(json, "family", asked.device.identity().family);
    add_member(json, "mode", std::string{name_of(asked.mode())});
    add_member(json, "requests", asked.device.plan_counters().requests);
    json.name("milliseconds");
    json.word(std::to_string(asked.read_ms));
    json.name("variables");
    json.begin_list();
    for (std::size_t i = 0; i < config.variables.size(); ++i) {
        json.begin_object();
        add_member(json, "name", config.variables[i].name);
        add_member(json, "at", config.variables[i].at);
        add_member(json, "status", std::string{name(asked.status_of(i))});
        if (const std::string reason = asked.reason_of(i); !reason.empty()) {
            add_member(json, "reason", reason);
        }
        if (const auto value = asked.value_of(i)) {
            add_member(json, "value", binary::to_text(*value));
        }
        json.end_object();
    }
    json.end_list();
    json.end_object();
}

} // namespace

bool check_backends(const ControllerConfig& config, detail::JsonWriter* json)
{
    NullLog no_log;
    std::vector<std::unique_ptr<Asked>> all;
    net::DeviceLoop loop{no_log};
    Duration patience{0};
    for (const BackendConfig& each : config.backends) {
        all.push_back(std::make_unique<Asked>(each, no_log));
        loop.add(all.back()->device);
        patience = std::max(patience, 2 * each.device.connect_timeout + std::chrono::seconds{1});
    }
    const auto look_at_all = [&] { std::ranges::for_each(all, [](auto& each) { look(*each); }); };
    static_cast<void>(loop.run_until(
        [&] {
            look_at_all();
            return std::ranges::none_of(all, [](const auto& each) { return each->is_waiting(); });
        },
        patience));
    static_cast<void>(loop.run_until(
        [&] {
            look_at_all();
            return std::ranges::all_of(
                all, [](const auto& each) { return !each->batch || each->result.has_value(); });
        },
        std::chrono::minutes{10}));
    for (const auto& each : all) {
        if (json != nullptr) {
            write_json(*json, *each);
        } else {
            print_text(*each);
        }
    }
    return std::ranges::all_of(
        all, [](const auto& each) { return each->result && each->refused() == 0; });
}

} // namespace busbar::product
