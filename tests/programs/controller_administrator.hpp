#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/variant.hpp>

#include "tool/connection/connection.hpp"

namespace busbar::test {

/// A setting's value: a text, a whole number or a flag; empty if it is null.
[[nodiscard]] std::string setting_text(const Variant& value);

/// Roles that the simulation closes and opens; the administrator needs none of them.
inline constexpr std::array drawn_roles{"Observer", "Engineer", "Supervisor"};

/// What a client knows of a change that it asked for.
enum class Outcome : std::uint8_t {
    Done,
    Refused,
    /// There was no answer.
    Unknown,
};

/// What a controller says of itself.
struct ControllerReport {
    struct SettingReport {
        std::string value; // null: empty
        bool is_changed{false};
        bool waits{false};
    };

    std::map<std::string, SettingReport> settings;
    /// Without those of the configuration's file.
    std::set<std::string> users;
    std::string program;
    bool is_received{false};
    std::string mode;
    /// Of the machine's variables, those that are there; nothing: it has no value yet, or that is
    /// no DINT.
    std::map<std::string, std::optional<std::int64_t>> values;
    /// Thumbprints.
    std::set<std::string> trusted;
    /// Of drawn_roles, those that are for nobody (EndpointsExclude).
    std::set<std::string> closed_roles;
    std::vector<std::string> restart_reasons;
    std::vector<std::string> pending_changes;
    std::int64_t max_sessions{0};
    std::string application_name;
};

/// An administrator at the tools of `busbar`, who connects again when he has to.
class ControllerAdministrator {
public:
    /// The controller listens on one of these ports. `pki` is the folder of his certificates.
    ControllerAdministrator(std::vector<std::string> ports, std::string pki, std::string password);

    /// Before the controller is killed and before it starts.
    void disconnect() { connection_.reset(); }

    /// Nothing if the controller went away.
    [[nodiscard]] std::optional<ControllerReport> report(const std::vector<std::string>& settings,
                                                         const std::vector<std::string>& variables);
    /// Null values take changes back.
    [[nodiscard]] Outcome set(const std::map<std::string, Variant>& values);
    [[nodiscard]] Outcome add_user(const std::string& name, const std::string& password);
    [[nodiscard]] Outcome change_password(const std::string& name, const std::string& password);
    [[nodiscard]] Outcome remove_user(const std::string& name);
    /// Has nobody be given a role any more, or those who were.
    [[nodiscard]] Outcome close_role(const std::string& role, bool is_closed);
    [[nodiscard]] Outcome trust(const std::vector<std::byte>& der);
    /// Begins to have the controller make a certificate of its own: DeleteCertificate.
    [[nodiscard]] Outcome forget_own_certificate();
    [[nodiscard]] Outcome distrust(const std::string& thumbprint);
    /// "edit press.st", "restore" and so on; see product::ProgramService.
    [[nodiscard]] Outcome program(const std::string& wish, const std::string& text);
    [[nodiscard]] std::optional<std::string> back_up();
    /// "restore", "clear" and so on; see product::MachineBackup.
    [[nodiscard]] Outcome replace_memory(const std::string& wish, const std::string& backup);
    [[nodiscard]] Outcome write(const std::string& variable, std::int32_t value);
    [[nodiscard]] Outcome restart();
    /// ResetToServerDefaults.
    [[nodiscard]] Outcome reset();
    /// "write", "update" and so on; see product::ProjectService.
    [[nodiscard]] Outcome project(const std::string& wish, const std::string& document);
    /// What is in the store, how it says that is, and the value of `number` in the models that it
    /// serves; nothing: it has none.
    struct ProjectReport {
        std::string document;
        std::string state;
        std::optional<std::int32_t> number;
    };
    /// Nothing if the controller went away.
    [[nodiscard]] std::optional<ProjectReport> project_report(const std::string& number);
    /// Whether a user gets in; nothing if the controller went away.
    [[nodiscard]] std::optional<bool> can_log_in(const std::string& user,
                                                 const std::string& password);

    /// Where the controller was reached last.
    [[nodiscard]] const std::string& port() const { return ports_.front(); }
    /// Of the last one that was refused.
    [[nodiscard]] const std::string& why_not() const { return why_not_; }

private:
    [[nodiscard]] std::unique_ptr<tool::Connection> connect(const std::string& user,
                                                            const std::string& password);
    [[nodiscard]] tool::Connection& connection();
    [[nodiscard]] const NodeId& machine(tool::Connection& connection);
    [[nodiscard]] Outcome tried(const std::function<void(tool::Connection&)>& act);
    [[nodiscard]] Outcome sent(const char* object, const std::string& wish,
                               const std::string& file);

    tool::Context context_;
    /// The one that was reached last is the first.
    std::vector<std::string> ports_;
    std::string password_;
    std::unique_ptr<tool::Connection> connection_;
    NodeId machine_; // NodeIds of the machine's variables are in its namespace
    std::string why_not_;
};

} // namespace busbar::test
