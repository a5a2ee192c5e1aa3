#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <busbar/controller/project.hpp>

/// The values of a project and their names in its file, in one place for all functions that visit
/// them. A visitor has text(), flag(), number(), list() and choice(), each with the name and the
/// value.
namespace busbar::controller::detail {

template <typename T, std::size_t count>
using Choices = std::array<std::pair<std::string_view, T>, count>;

inline constexpr Choices<ProjectPermission, 3> permissions{
    {{"tool", ProjectPermission::Tool},
     {"client", ProjectPermission::Client},
     {"tool and client", ProjectPermission::ToolAndClient}}};

inline constexpr Choices<ListenerUse, 3> listener_uses{
    {{"data", ListenerUse::Data},
     {"administration", ListenerUse::Administration},
     {"data and administration", ListenerUse::DataAndAdministration}}};

inline constexpr Choices<MessageSecurityMode, 3> security_modes{
    {{"None", MessageSecurityMode::None},
     {"Sign", MessageSecurityMode::Sign},
     {"SignAndEncrypt", MessageSecurityMode::SignAndEncrypt}}};

inline constexpr Choices<ProjectSampling, 3> sampling_modes{
    {{"standard", ProjectSampling::Standard},
     {"high-speed items", ProjectSampling::HighSpeedItems},
     {"high-speed variables", ProjectSampling::HighSpeedVariables}}};

// `Of` is Project, ProjectUser and so on, const or not.

template <typename Visitor, typename Of>
void visit_project(Visitor& visitor, Of& project)
{
    visitor.text("preset", project.preset);
}

template <typename Visitor, typename Of>
void visit_network(Visitor& visitor, Of& project)
{
    visitor.text("gateway", project.network.gateway);
    visitor.text("host_name", project.network.host_name);
}

template <typename Visitor, typename Of>
void visit_security(Visitor& visitor, Of& project)
{
    visitor.list("policies", project.security.policies);
    visitor.choice("mode", project.security.mode, security_modes);
    visitor.flag("tool_logs_in", project.security.tool_logs_in);
    visitor.flag("allow_certificates", project.security.allows_certificates);
    visitor.flag("allow_passwords", project.security.allows_passwords);
    visitor.flag("allow_anonymous", project.security.allows_anonymous);
    visitor.flag("trust_all_clients", project.security.trusts_all_clients);
}

template <typename Visitor, typename Of>
void visit_certificate(Visitor& visitor, Of& project)
{
    visitor.text("server_name", project.certificate.server_name);
    visitor.text("organization", project.certificate.organization);
    visitor.text("unit", project.certificate.unit);
    visitor.text("locality", project.certificate.locality);
    visitor.text("state", project.certificate.state);
    visitor.text("country", project.certificate.country);
}

template <typename Visitor, typename Of>
void visit_discovery(Visitor& visitor, Of& project)
{
    visitor.text("url", project.discovery.url);
    visitor.number("interval_s", project.discovery.interval);
}

template <typename Visitor, typename Of>
void visit_sampling(Visitor& visitor, Of& project)
{
    visitor.choice("mode", project.sampling, sampling_modes);
}

template <typename Visitor, typename Of>
void visit_listener(Visitor& visitor, Of& listener)
{
    visitor.choice("use", listener.use, listener_uses);
    visitor.text("address", listener.address);
    visitor.text("mask", listener.mask);
    visitor.number("port", listener.port);
}

template <typename Visitor, typename Of>
void visit_user(Visitor& visitor, Of& user)
{
    visitor.text("name", user.name);
    visitor.choice("permission", user.permission, permissions);
    visitor.text("password_hash", user.password_hash);
}

/// Calls `each(section, visit)` for all sections that occur once.
template <typename Each>
void for_each_section(Each each)
{
    each("network", [](auto& visitor, auto& project) { visit_network(visitor, project); });
    each("security", [](auto& visitor, auto& project) { visit_security(visitor, project); });
    each("certificate", [](auto& visitor, auto& project) { visit_certificate(visitor, project); });
    each("discovery", [](auto& visitor, auto& project) { visit_discovery(visitor, project); });
    each("sampling", [](auto& visitor, auto& project) { visit_sampling(visitor, project); });
}

/// Number of sections that occur once.
inline constexpr std::size_t section_count = 5;

/// True for text that fits on a line: UTF-8 without control characters.
[[nodiscard]] bool is_project_text(std::string_view text);

/// Convert between a value and its text in the file. If the text is not valid, `read_value` leaves
/// `to` alone and returns what was expected; an empty result is success.
template <typename T, std::size_t count>
[[nodiscard]] std::string_view value_text(const T& value, const Choices<T, count>& choices)
{
    for (const auto& [name, choice] : choices) {
        if (choice == value) {
            return name;
        }
    }
    return choices.front().first;
}
[[nodiscard]] std::string value_text(const std::vector<std::string>& list);

template <typename T, std::size_t count>
[[nodiscard]] std::string read_value(std::string_view text, T& to, const Choices<T, count>& choices)
{
    std::string expected;
    for (const auto& [name, choice] : choices) {
        if (name == text) {
            to = choice;
            return {};
        }
        expected += (expected.empty() ? "" : ", ") + std::string{name};
    }
    return "one of: " + expected;
}
[[nodiscard]] std::string read_value(std::string_view text, bool& to);
[[nodiscard]] std::string read_value(std::string_view text, std::uint32_t& to);
[[nodiscard]] std::string read_value(std::string_view text, std::vector<std::string>& to);

} // namespace busbar::controller::detail
