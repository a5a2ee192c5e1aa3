#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/administration/authorities.hpp>
#include <busbar/administration/file_system.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/controller/machine_nodes.hpp>
#include <busbar/controller/machine_settings.hpp>
#include <busbar/controller/plc_config.hpp>
#include <busbar/controller/plc_task.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/controller/published_program.hpp>
#include <busbar/controller/simulated_labels.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/jwt.hpp>
#include <busbar/crypto/store_limits.hpp>
#include <busbar/server/password_rules.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server_config.hpp>

#include "product/backend/backend_config.hpp"
#include "subject_names.hpp"
#include "toml_reader.hpp"

namespace busbar::product {

/// A user's access to variables; with None the user can only administer.
enum class AccountAccess : std::uint8_t { None, Read, Write };

struct Account {
    std::string name;
    std::string password_hash;
    AccountAccess access{AccountAccess::Write};
    /// Well-known roles (Part 3, 4.9.2), which determine access to the nodes of namespace 0.
    std::vector<std::string> roles{"Operator"};

    friend bool operator==(const Account&, const Account&) = default;
};

/// Users with a token from another issuer.
struct TokenConfig {
    crypto::JwtRules rules;
    std::vector<std::pair<std::string, AccountAccess>> roles;
};

/// The users that may log in; kinds that are not set may not.
struct UserConfig {
    std::optional<AccountAccess> anonymous;
    std::optional<AccountAccess> certified; // with a certificate that lies in users/trusted
    std::vector<Account> accounts;
    std::optional<TokenConfig> tokens;
    /// Until there is an administrator, admits a user with the code that the first start prints.
    bool has_setup{false};
    /// The roles that may see what administrators change.
    administration::Authorities authorities{administration::Authorities::Standard};
    /// Rules for users that are added online; the cost applies to all new hashes.
    server::PasswordRules password_rules;
};

[[nodiscard]] bool has_account(const UserConfig& users, const std::string& name);
/// True if no user can log in.
[[nodiscard]] bool is_nobody(const UserConfig& users);

struct CertificateConfig {
    /// The folder of the own certificate and key, and of the trust lists.
    std::string folder{"busbar-certificates"};
    /// Accepts every client's certificate. For the demo and tests only.
    bool trusts_all_clients{false};
    // Of the own certificate, when it is made.
    std::uint32_t key_bits{2'048};
    std::uint32_t valid_days{7'305}; // 20 years
    SubjectNames subject;
    crypto::StoreLimits limits;
    crypto::ValidationSettings validation;
};

/// The discovery server that the controller registers with, so that clients find it.
struct DiscoveryConfig {
    /// Empty for none.
    std::string url;
    std::chrono::seconds interval{300};
    /// Accepts a discovery server without security.
    bool allows_none{false};

    friend bool operator==(const DiscoveryConfig&, const DiscoveryConfig&) = default;
};

/// A folder whose files clients can see.
struct FilesConfig {
    std::string name;
    std::string folder;
    // Well-known roles.
    std::vector<std::string> readers;
    std::vector<std::string> writers;
    administration::FileLimits limits;
};

/// A controller that publishes the variables of its program automatically (W588).
struct MachineConfig {
    /// Null for none.
    std::shared_ptr<const controller::CheckedProgram> program;
    /// The file in the configuration.
    std::string program_file;
    /// Name of the program's file, which differs if the program was received.
    std::string program_name;
    /// Text of the program's file, for comparing; null without a program.
    std::shared_ptr<const std::string> program_text;
    ProgramReading reading{};
    /// True if another program may leave out what the one before it does not.
    bool may_leave_out_more{false};
    /// Name of the folder that contains the machine's nodes; if empty, the server's name.
    std::string name;
    /// True if there is an OPC UA server for clients (W588, 3-2-2). Without one the program runs
    /// and no port is opened. Takes effect at a start.
    bool is_used{true};
    controller::MachineMode mode{controller::MachineMode::Run};
    /// Folder for the events.
    std::string state_folder{"busbar-machine"};
    /// The memory card, with the execution log.
    std::string medium_folder{"busbar-medium"};
    /// Whether a start makes that folder; otherwise it is away until it is there (W588, 7-4-1).
    bool makes_medium{true};
    controller::ExecutionLogSettings execution_log;
    /// Events whose level differs from the default (W588, 9-2-1).
    std::vector<controller::EventLevelChoice> event_levels;
    /// True if clients can simulate signals of the hardware (see publish_hardware).
    bool simulates_hardware{false};
    /// Interval for saving the values of RETAIN variables, if they have changed.
    std::chrono::milliseconds retained{10'000};
    // As the preset has them; the types also as the configuration says.
    controller::PublishingLimits publishing;
    controller::MachineTypeOptions types{.elementary = controller::ElementaryTypes::BuiltIn};
    /// The PLCopen model whatever `types` are.
    bool has_plcopen{false};
};

/// The PLC whose variables are labels, for a server of model mode (SH-082679, 8.3).
struct LabelConfig {
    /// Null for none.
    std::shared_ptr<const controller::Program> program;
    std::string program_file;
    ProgramReading reading{};
    /// Text of the program's file, for comparing; null without a program.
    std::shared_ptr<const std::string> program_text;
    controller::SimulatedLabelsOptions options;
    /// See MachineConfig.
    bool may_leave_out_more{false};
    /// Minutes that the PLC's clock is ahead of UTC; if empty, the same as this machine's.
    std::optional<std::int32_t> utc_offset;
    /// The PLC on the network that has the labels; null if the program does, or nothing.
    std::shared_ptr<const backend::SlmpLabelsOptions> field;
    /// The keys of that PLC, for comparing.
    std::string field_text;
    /// See MappedOptions.
    bool isolates_failures{false};
    std::chrono::milliseconds call_limit{4'000};

    /// True if there are labels, which are of a PLC other than that of [plc].
    [[nodiscard]] bool has_plc() const { return program != nullptr || field != nullptr; }
};

/// The number of a listener for net::ServerLoop::listen; its default, 0, is for all uses.
using controller::ListenerUse;

/// An address and port for clients in addition to those of the server.
struct FurtherListener {
    std::string address;
    std::uint16_t port{4840};
    ListenerUse use{ListenerUse::DataAndAdministration};

    friend bool operator==(const FurtherListener&, const FurtherListener&) = default;
};

/// The contents of a configuration file.
struct ControllerConfig {
    server::ServerConfig server;
    /// "" is every address of the machine.
    std::string address;
    std::uint16_t port{4840};
    /// Lower limit of the port for the file and administrators, from the product of the preset.
    std::uint16_t least_port{0};
    ListenerUse use{ListenerUse::DataAndAdministration};
    /// The additional listeners of a project of model mode.
    std::vector<FurtherListener> further_listeners;
    /// Hosts by which clients reach the machine, besides the address and its own name.
    std::vector<std::string> host_names;
    /// Listeners of clients that cannot reach the server, to which the server connects instead.
    std::vector<std::string> reverse_urls;
    DiscoveryConfig discovery;
    /// File for the keys of all channels, in builds with BUSBAR_KEY_LOG; empty for none.
    std::string key_log;
    /// NodeSet2 files with additional information models to serve.
    std::vector<std::string> nodesets;
    /// False repairs what files of vendors often have wrong.
    bool nodesets_strict{true};
    CertificateConfig certificates;
    UserConfig users;
    std::vector<FilesConfig> files;
    std::chrono::milliseconds scan{20};
    /// Real-time priority of the PLC's task if the system permits it, 1 to 99; 0 for none.
    int realtime_priority{controller::PlcTask::usual_priority};
    server::ImageOptions image;
    MachineConfig machine;
    LabelConfig labels;
    /// Without variables if the machine has a program, or there are labels.
    controller::PlcConfig plc;
    /// PLCs on the network, whose variables are served besides.
    std::vector<BackendConfig> backends;
};

/// Refuses a text that cannot be a node's name.
void check_name(const TomlTable& table, std::string_view key, std::string_view name);
/// Makes endpoints offer the kinds of user that are configured.
void offer_users(ControllerConfig& config);

// Reading a configuration. All throw ConfigError.

/// Reads the text of a file; the built-in one if `path` is empty.
[[nodiscard]] std::string read_config_text(const std::string& path, SourceFiles& sources);
/// Messages call the file `file`.
[[nodiscard]] toml::table parse_table(std::string_view text, const std::string& file);
/// Converts a table to a configuration. A value without a line was changed online instead of read
/// from the file. `sources` provides the files that the configuration names.
[[nodiscard]] ControllerConfig config_of(const toml::table& table, const std::string& file,
                                         SourceFiles& sources);
/// The folder of certificates, which can be read even if other parts of the file are invalid.
[[nodiscard]] std::string certificate_folder(const toml::table& table);
[[nodiscard]] ControllerConfig parse_config(std::string_view text, const std::string& file);
[[nodiscard]] ControllerConfig read_config(const std::string& path);
/// Reads the built-in configuration if `path` is empty.
[[nodiscard]] ControllerConfig read_config_or_default(const std::string& path);

} // namespace busbar::product
