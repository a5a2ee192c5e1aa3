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

/// The project of model mode (seed 001, 9.3): all that a server module is set up with, as plain
/// values and as one file.
namespace busbar::controller {

/// An information model: a NodeSet2 file with its mapping in it (seed 001, Appendix 8).
struct ProjectModel {
    /// What it was imported from, for messages: "Server_A.xml".
    std::string name;
    std::string text;

    friend bool operator==(const ProjectModel&, const ProjectModel&) = default;
};

/// Whom a user may talk to the server with (seed 001, 9.7).
enum class ProjectPermission : std::uint8_t { Tool, Client, ToolAndClient };

struct ProjectUser {
    std::string name;
    ProjectPermission permission{ProjectPermission::ToolAndClient};
    /// See crypto::hash_password. A project never has a password.
    std::string password_hash;

    friend bool operator==(const ProjectUser&, const ProjectUser&) = default;
};

/// What a listener is for.
enum class ListenerUse : std::uint8_t { DataAndAdministration, Data, Administration };

/// An Ethernet port (seed 001, 9.8).
struct ProjectListener {
    ListenerUse use{ListenerUse::DataAndAdministration};
    /// IPv4; empty is every address of the machine, for a listener that is alone.
    std::string address;
    std::string mask{"255.255.255.0"};
    std::uint32_t port{4840};

    friend bool operator==(const ProjectListener&, const ProjectListener&) = default;
};

struct ProjectNetwork {
    /// At least one, of which one is for data.
    std::vector<ProjectListener> listeners{ProjectListener{}};
    /// In the network of one of the listeners; empty: none. For whoever sets the machine's
    /// addresses.
    std::string gateway;
    /// Common to all listeners; may be empty.
    std::string host_name;

    friend bool operator==(const ProjectNetwork&, const ProjectNetwork&) = default;
};

/// How channels are secured and who may log in (seed 001, 9.9).
struct ProjectSecurity {
    /// Names as crypto::find_policy_by_name has them. None of them: everything is allowed that
    /// there is, no security too.
    std::vector<std::string> policies{"Aes256_Sha256_RsaPss", "Aes128_Sha256_RsaOaep",
                                      "Basic256Sha256"};
    /// The weakest that is allowed: None without policies, and not with any.
    MessageSecurityMode mode{MessageSecurityMode::Sign};
    /// Whoever administers the server has to log in.
    bool tool_logs_in{true};
    bool allows_certificates{false};
    bool allows_passwords{true};
    bool allows_anonymous{false};
    /// Certificates of clients are trusted as they come, for tests.
    bool trusts_all_clients{false};

    friend bool operator==(const ProjectSecurity&, const ProjectSecurity&) = default;
};

/// What the server's own certificate says (seed 001, 9.10); empty is left out.
struct ProjectCertificate {
    std::string server_name;
    std::string organization;
    std::string unit;
    std::string locality;
    std::string state;
    std::string country; // two letters

    friend bool operator==(const ProjectCertificate&, const ProjectCertificate&) = default;
};

/// Where the server makes itself known (seed 001, 9.11).
struct ProjectDiscovery {
    /// Empty: nowhere.
    std::string url;
    std::uint32_t interval{300}; // seconds

    friend bool operator==(const ProjectDiscovery&, const ProjectDiscovery&) = default;
};

/// How values of the PLC are collected (seed 001, 9.12).
enum class ProjectSampling : std::uint8_t { Standard, HighSpeedItems, HighSpeedVariables };

struct Project {
    /// "rd81opc96": has that product's ceilings and characters. Empty: none of them.
    std::string preset;
    ProjectNetwork network{};
    ProjectSecurity security{};
    ProjectCertificate certificate{};
    ProjectDiscovery discovery{};
    ProjectSampling sampling{ProjectSampling::Standard};
    std::vector<ProjectUser> users{};
    /// In the order of their namespaces: what a model requires comes before it.
    std::vector<ProjectModel> models{};

    friend bool operator==(const Project&, const Project&) = default;
};

/// What of a project file is read at most; the preset's ceilings are check()'s.
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

/// The project as a file, of lines that people can read and compare:
///
///     busbar project 1
///     preset = rd81opc96
///
///     [network]
///     gateway =
///     host_name = PRESS4
///
/// and so on; [listener], [user] and [model] as often as there are any, each value once and on a
/// line of its own, to its end. A [model] has `name`, `size` in bytes and `checksum`, and is
/// followed by the NodeSet2 file as it is. The last section is [end] with the CRC-32 of all lines
/// before its value, so that no damage passes for another value: change values by a program.
///
/// A problem for what could not be read again: control characters in a value, or more than the
/// limits allow.
[[nodiscard]] BUSBAR_API Configured<std::string> document_of(const Project& project,
                                                             const ProjectLimits& limits = {});

/// Reads such a file. `where` of a problem begins with `file` and has the line: "line4.busbar:12:
/// [network] host_name"; a file of another version is refused with its number. Whether the values
/// make sense is for check() to say.
[[nodiscard]] BUSBAR_API Configured<Project>
read_project(std::string_view document, const std::string& file, const ProjectLimits& limits = {});

/// Whether the values make sense (seed 001, 9.7 to 9.12, and Appendix 6 with the preset). The first
/// that does not: `where` is "[listener 2] address". Models are only counted: see load_models.
[[nodiscard]] BUSBAR_API Configured<void> check(const Project& project);

/// A value that people change one at a time, as the file has it: "network.host_name",
/// "listener 2.port", "user 1.permission". Numbers count from 1; one more than there are adds one,
/// and an empty value for "listener 2" or "user 1" removes it.
[[nodiscard]] BUSBAR_API Configured<void> set_project_value(Project& project, std::string_view name,
                                                            std::string_view value);

/// One value as the file has it; its name is one for set_project_value.
struct ProjectValue {
    std::string name;
    std::string value;

    friend bool operator==(const ProjectValue&, const ProjectValue&) = default;
};
/// All values but models, in the file's order.
[[nodiscard]] BUSBAR_API std::vector<ProjectValue> values_of(const Project& project);

/// "opc.tcp://192.168.3.40:4840": what clients use, of each listener that is for data, with its
/// address and with the host name (seed 001, 9.8).
[[nodiscard]] BUSBAR_API std::vector<std::string> endpoint_urls(const ProjectNetwork& network);

/// What is allowed in the end, of the policies that this build has (seed 001, 9.9).
[[nodiscard]] BUSBAR_API std::vector<MessageSecurity>
allowed_security(const ProjectSecurity& security);

} // namespace busbar::controller
