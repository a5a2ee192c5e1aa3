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

#include "subject_names.hpp"
#include "toml_reader.hpp"

namespace busbar::product {

/// What users may do with variables; with None they administer and do nothing else.
enum class AccountAccess : std::uint8_t { None, Read, Write };

struct Account {
    std::string name;
    std::string password_hash;
    AccountAccess access{AccountAccess::Write};
    /// Well-known roles (Part 3, 4.9.2), which the nodes of namespace 0 go by.
    std::vector<std::string> roles{"Operator"};

    friend bool operator==(const Account&, const Account&) = default;
};

/// Users who show a token that somebody else has issued.
struct TokenConfig {
    crypto::JwtRules rules;
    std::vector<std::pair<std::string, AccountAccess>> roles;
};

/// Who may log in; what is not there may not.
struct UserConfig {
    std::optional<AccountAccess> anonymous;
    std::optional<AccountAccess> certified; // with a certificate that lies in users/trusted
    std::vector<Account> accounts;
    std::optional<TokenConfig> tokens;
    /// Until there is an administrator, lets in who knows the code that the first start prints.
    bool has_setup{false};
    /// Who may look at what administrators change.
    administration::Authorities authorities{administration::Authorities::Standard};
    /// Of users who are added online; the cost is also that of all other new hashes.
    server::PasswordRules password_rules;
};

[[nodiscard]] bool has_account(const UserConfig& users, const std::string& name);
/// Whether nobody can log in.
[[nodiscard]] bool is_nobody(const UserConfig& users);

struct CertificateConfig {
    /// The folder of the own certificate and key, and of the trust lists.
    std::string folder{"busbar-certificates"};
    /// Whatever certificate a client shows is accepted. For the demo and tests only.
    bool trusts_all_clients{false};
    // Of the own certificate, when it is made.
    std::uint32_t key_bits{2'048};
    std::uint32_t valid_days{7'305}; // 20 years
    SubjectNames subject;
    crypto::StoreLimits limits;
    crypto::ValidationSettings validation;
};

/// The discovery server that clients find this controller with.
struct DiscoveryConfig {
    /// Empty: there is none.
    std::string url;
    std::chrono::seconds interval{300};
    /// A discovery server without security will do.
    bool allows_none{false};

    friend bool operator==(const DiscoveryConfig&, const DiscoveryConfig&) = default;
};

/// A folder whose files clients see.
struct FilesConfig {
    std::string name;
    std::string folder;
    // Well-known roles.
    std::vector<std::string> readers;
    std::vector<std::string> writers;
    administration::FileLimits limits;
};

/// A controller that publishes the variables of its program by itself (W588).
struct MachineConfig {
    /// Null: there is none.
    std::shared_ptr<const controller::CheckedProgram> program;
    /// What the configuration names.
    std::string program_file;
    /// That of the program, which is another one if it was received.
    std::string program_name;
    /// The file's, to tell whether it is another one; null without a program.
    std::shared_ptr<const std::string> program_text;
    /// Of the folder that has everything; empty: the server's name.
    std::string name;
    /// Whether there is an OPC UA server for clients (W588, 3-2-2): without one the program
    /// runs, and no port is opened. Counts from a start on.
    bool is_used{true};
    controller::MachineMode mode{controller::MachineMode::Run};
    /// Where events are kept.
    std::string state_folder{"busbar-machine"};
    /// The memory card: where the execution log is.
    std::string medium_folder{"busbar-medium"};
    /// Whether a start makes that folder; otherwise it is away until it is there (W588, 7-4-1).
    bool makes_medium{true};
    controller::ExecutionLogSettings execution_log;
    /// Of events that have another one than the system's (W588, 9-2-1).
    std::vector<controller::EventLevelChoice> event_levels;
    /// Whether clients may tell what its hardware would (see publish_hardware).
    bool simulates_hardware{false};
    /// How often values of RETAIN variables are saved, if they have changed.
    std::chrono::milliseconds retained{10'000};
    // As the preset has them; the types also as the configuration says.
    controller::PublishingLimits publishing;
    controller::MachineTypeOptions types{.elementary = controller::ElementaryTypes::BuiltIn};
    /// The PLCopen model whatever `types` are.
    bool has_plcopen{false};
};

/// The PLC whose variables are labels, for a server of model mode (SH-082679, 8.3).
struct LabelConfig {
    /// Null: there are none.
    std::shared_ptr<const controller::Program> program;
    std::string program_file;
    /// The file's, to tell whether it is another one; null without a program.
    std::shared_ptr<const std::string> program_text;
    controller::SimulatedLabelsOptions options;
    /// Minutes that the PLC's clock is ahead of UTC; nothing: as many as this machine's.
    std::optional<std::int32_t> utc_offset;
    /// See MappedOptions.
    bool isolates_failures{false};
    std::chrono::milliseconds call_limit{4'000};
};

/// As a number for net::ServerLoop::listen; its default, 0, is for all.
using controller::ListenerUse;

/// Where else clients connect to than at the address and port of the server.
struct FurtherListener {
    std::string address;
    std::uint16_t port{4840};
    ListenerUse use{ListenerUse::DataAndAdministration};

    friend bool operator==(const FurtherListener&, const FurtherListener&) = default;
};

/// Everything a configuration file says.
struct ControllerConfig {
    server::ServerConfig server;
    /// "" is every address of the machine.
    std::string address;
    std::uint16_t port{4840};
    /// The file and administrators set no lower one, as the product of the preset has none.
    std::uint16_t least_port{0};
    ListenerUse use{ListenerUse::DataAndAdministration};
    /// Of a project of model mode.
    std::vector<FurtherListener> further_listeners;
    /// By which clients reach the machine, beyond the address and its own name.
    std::vector<std::string> host_names;
    /// Listeners of clients that cannot reach the server; it connects to them.
    std::vector<std::string> reverse_urls;
    DiscoveryConfig discovery;
    /// Where the keys of all channels are written, in builds with BUSBAR_KEY_LOG; empty for
    /// nowhere.
    std::string key_log;
    /// NodeSet2 files with information models that are served, too.
    std::vector<std::string> nodesets;
    CertificateConfig certificates;
    UserConfig users;
    std::vector<FilesConfig> files;
    std::chrono::milliseconds scan{20};
    /// Of the PLC's task where the system permits it, 1 to 99; 0 is none.
    int realtime_priority{controller::PlcTask::usual_priority};
    server::ImageOptions image;
    MachineConfig machine;
    LabelConfig labels;
    /// Without variables where the machine has a program, or labels have.
    controller::PlcConfig plc;
};

/// Refuses a text that cannot be the name of a node.
void check_name(const TomlTable& table, std::string_view key, std::string_view name);
/// Has endpoints offer the kinds of user that there are.
void offer_users(ControllerConfig& config);

// Reading a configuration. All throw ConfigError.

/// What a file has in it; the built-in one if `path` is empty.
[[nodiscard]] std::string read_config_text(const std::string& path, SourceFiles& sources);
/// `file` is its name in messages.
[[nodiscard]] toml::table parse_table(std::string_view text, const std::string& file);
/// What has no line was not read from the file, but changed online. `sources` has the files that
/// the configuration names.
[[nodiscard]] ControllerConfig config_of(const toml::table& table, const std::string& file,
                                         SourceFiles& sources);
/// Where certificates lie, and what is kept beside them; whatever else is wrong in the file.
[[nodiscard]] std::string certificate_folder(const toml::table& table);
[[nodiscard]] ControllerConfig parse_config(std::string_view text, const std::string& file);
[[nodiscard]] ControllerConfig read_config(const std::string& path);
/// The built-in one if `path` is empty.
[[nodiscard]] ControllerConfig read_config_or_default(const std::string& path);

} // namespace busbar::product
