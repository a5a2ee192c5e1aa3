#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/machine_settings.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

/// The project of model mode (SH-082679, 9.3): the complete configuration of a server
/// module, as plain values and as one file.
namespace busbar::controller {

/// An information model: a NodeSet2 file that includes its mapping (SH-082679, Appendix
/// 8).
struct ProjectModel {
    /// The file that it was imported from, for messages: "Server_A.xml".
    std::string name;
    std::string text;

    friend bool operator==(const ProjectModel&, const ProjectModel&) = default;
};

/// The programs with which a user may connect to the server (SH-082679, 9.7).
enum class ProjectPermission : std::uint8_t { Tool, Client, ToolAndClient };

/// A user of the module.
struct ProjectUser {
    std::string name;
    ProjectPermission permission{ProjectPermission::ToolAndClient};
    /// See crypto::hash_password. A project never contains a password.
    std::string password_hash;

    friend bool operator==(const ProjectUser&, const ProjectUser&) = default;
};

/// The use of a listener.
enum class ListenerUse : std::uint8_t { DataAndAdministration, Data, Administration };

/// An Ethernet port (SH-082679, 9.8).
struct ProjectListener {
    ListenerUse use{ListenerUse::DataAndAdministration};
    /// IPv4; empty for every address of the machine, if it is the only listener.
    std::string address;
    std::string mask{"255.255.255.0"};
    std::uint32_t port{4840};

    friend bool operator==(const ProjectListener&, const ProjectListener&) = default;
};

/// Addresses and names of the module in its networks.
struct ProjectNetwork {
    /// At least one; one of them is for data.
    std::vector<ProjectListener> listeners{ProjectListener{}};
    /// In the network of one of the listeners; empty: none. For the program that sets the machine's
    /// addresses.
    std::string gateway;
    /// Common to all listeners; may be empty.
    std::string host_name;

    friend bool operator==(const ProjectNetwork&, const ProjectNetwork&) = default;
};

/// The security of channels and the users that may log in (SH-082679, 9.9).
struct ProjectSecurity {
    /// Names for crypto::find_policy_by_name. If empty, every policy of the build is allowed, and
    /// no security as well.
    std::vector<std::string> policies{"Aes256_Sha256_RsaPss", "Aes128_Sha256_RsaOaep",
                                      "Basic256Sha256"};
    /// The weakest allowed mode: None without policies, and never with any.
    MessageSecurityMode mode{MessageSecurityMode::Sign};
    /// Tools that administer the server must log in.
    bool tool_logs_in{true};
    bool allows_certificates{false};
    bool allows_passwords{true};
    bool allows_anonymous{false};
    /// Certificates of clients are trusted without a check, for tests.
    bool trusts_all_clients{false};

    friend bool operator==(const ProjectSecurity&, const ProjectSecurity&) = default;
};

/// The contents of the server's own certificate (SH-082679, 9.10); empty values are
/// omitted.
struct ProjectCertificate {
    std::string server_name;
    std::string organization;
    std::string unit;
    std::string locality;
    std::string state;
    std::string country; // two letters

    friend bool operator==(const ProjectCertificate&, const ProjectCertificate&) = default;
};

/// The discovery server that the server registers with (SH-082679, 9.11).
struct ProjectDiscovery {
    /// If empty, the server does not register.
    std::string url;
    std::uint32_t interval{300}; // in seconds

    friend bool operator==(const ProjectDiscovery&, const ProjectDiscovery&) = default;
};

/// The way in which values of the PLC are collected (SH-082679, 9.12).
enum class ProjectSampling : std::uint8_t { Standard, HighSpeedItems, HighSpeedVariables };

/// Everything that a module is set up with.
struct Project {
    /// "rd81opc96" applies that product's limits and character sets. Empty: none of them.
    std::string preset;
    ProjectNetwork network{};
    ProjectSecurity security{};
    ProjectCertificate certificate{};
    ProjectDiscovery discovery{};
    ProjectSampling sampling{ProjectSampling::Standard};
    std::vector<ProjectUser> users{};
    /// In the order of their namespaces: a model comes after those that it requires.
    std::vector<ProjectModel> models{};

    friend bool operator==(const Project&, const Project&) = default;
};

/// Limits for reading a project file; the preset's limits are checked by check().
struct ProjectLimits {
    std::size_t max_file_size{256U << 20U};
    std::size_t max_model_size{64U << 20U};
    std::size_t max_models{1'000};
    std::size_t max_users{1'000};
    std::size_t max_listeners{16};
    std::size_t max_text{4'096}; // bytes of one value
};

/// The version of the format that is written.
inline constexpr std::uint32_t project_version = 1;

/// Writes the project as a file, in lines that people can read and compare:
///
///     busbar project 1
///     preset = rd81opc96
///
///     [network]
///     gateway =
///     host_name = PRESS4
///
/// and so on; [listener], [user] and [model] are repeated as needed. Each value appears once, on
/// one line, up to its end. A [model] has `name`, `size` in bytes and `checksum`, followed by the
/// unchanged NodeSet2 file. The last section is [end] with the CRC-32 of all lines before its
/// value, so that damage is never taken for another value: change values with a program.
///
/// A problem means that the file could not be read again: control characters in a value, or more
/// than the limits allow.
[[nodiscard]] BUSBAR_API Configured<std::string> document_of(const Project& project,
                                                             const ProjectLimits& limits = {});

/// Reads such a file. `where` of a problem begins with `file` and has the line: "line4.busbar:12:
/// [network] host_name"; a file with another version is refused, with its number. Whether the
/// values are valid is checked by check().
[[nodiscard]] BUSBAR_API Configured<Project>
read_project(std::string_view document, const std::string& file, const ProjectLimits& limits = {});

/// Checks whether the values are valid (SH-082679, 9.7 to 9.12, and Appendix 6 with the
/// preset). Reports the first that is not: `where` is "[listener 2] address". Models are only
/// counted: see load_models.
[[nodiscard]] BUSBAR_API Configured<void> check(const Project& project);

/// Sets a single value, as written in the file: "network.host_name", "listener 2.port", "user
/// 1.permission". Numbers count from 1; the number after the last one adds one, and an empty value
/// for "listener 2" or "user 1" removes it.
[[nodiscard]] BUSBAR_API Configured<void> set_project_value(Project& project, std::string_view name,
                                                            std::string_view value);

/// One value as in the file; its name is valid for set_project_value.
struct ProjectValue {
    std::string name;
    std::string value;

    friend bool operator==(const ProjectValue&, const ProjectValue&) = default;
};
/// Returns all values except models, in the file's order.
[[nodiscard]] BUSBAR_API std::vector<ProjectValue> values_of(const Project& project);

/// Returns the URLs for clients, such as "opc.tcp://192.168.3.40:4840", of each listener for data,
/// with its address and with the host name (SH-082679, 9.8).
[[nodiscard]] BUSBAR_API std::vector<std::string> endpoint_urls(const ProjectNetwork& network);

/// Returns the resulting allowed security, limited to the policies of this build (manual of model
/// mode, 9.9).
[[nodiscard]] BUSBAR_API std::vector<MessageSecurity>
allowed_security(const ProjectSecurity& security);

} // namespace busbar::controller
