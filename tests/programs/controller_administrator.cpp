#include "programs/controller_administrator.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>
#include <utility>

#include <busbar/core/status_codes.hpp>
#include <busbar/crypto/secret.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

#include "core/json.hpp"
#include "tool/admin/remote.hpp"
#include "tool/admin/remote_transfer.hpp"
#include "tool/nodes/nodes.hpp"

namespace busbar::test {

using namespace tool;
using admin::RemoteTransfer;
using admin::standard;

namespace {

constexpr const char* chief = "chief";

std::vector<std::string> texts_of(const Variant& value)
{
    std::vector<std::string> all;
    if (const auto* const list = value.array_if<String>()) {
        for (const String& each : *list) {
            all.push_back(each.str());
        }
    }
    return all;
}

Variant fact(Connection& connection, const std::string& name)
{
    return admin::read(connection, NodeId{1, String{"Status/" + name}});
}

/// What cannot be read because the controller went away is not what it has not.
std::vector<DataValue> values_of(Connection& connection, const std::vector<NamedNode>& nodes)
{
    auto values = read_nodes(connection, nodes);
    for (const DataValue& each : values) {
        if (each.status.is_bad() && exit_of(each.status) == Exit::NotConnected) {
            throw Failure{each.status, "reading"};
        }
    }
    return values;
}

NodeId settings_of(Connection& connection)
{
    return admin::child_of(connection, standard(id::ObjectsFolder), "Settings");
}

void report_settings(Connection& connection, const std::vector<std::string>& names,
                     ControllerReport& report)
{
    const NodeId root = settings_of(connection);
    std::vector<NamedNode> nodes;
    for (const std::string& name : names) {
        for (const char* aspect : {"", ".IsChanged", ".WaitsForRestart"}) {
            nodes.push_back(
                {name, NodeId{root.namespace_index(), String{"Settings." + name + aspect}}});
        }
    }
    const auto values = values_of(connection, nodes);
    auto next = values.begin();
    for (const std::string& name : names) {
        auto& setting = report.settings[name];
        setting.value = setting_text((next++)->value);
        setting.is_changed = (next++)->value.value_or<bool>(false);
        setting.waits = (next++)->value.value_or<bool>(false);
    }
}

void report_values(Connection& connection, const NodeId& machine,
                   const std::vector<std::string>& names, ControllerReport& report)
{
    std::vector<NamedNode> nodes;
    for (const std::string& name : names) {
        nodes.push_back({name, NodeId{machine.namespace_index(), String{name}}});
    }
    const auto values = values_of(connection, nodes);
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (values[i].status != status::Bad_NodeIdUnknown) {
            const auto* const number = values[i].value.get_if<std::int32_t>();
            report.values[names[i]] =
                number != nullptr ? std::optional<std::int64_t>{*number} : std::nullopt;
        }
    }
}

void report_program(Connection& connection, ControllerReport& report)
{
    RemoteTransfer transfer{connection, "Program", {}};
    report.program = transfer.fetch({});
    const auto status = busbar::detail::parse_json(transfer.fetch(Variant{"status"}));
    const auto text = [&](const char* name) {
        const auto* const found = status ? status->find(name) : nullptr;
        return found != nullptr ? found->text : std::string{};
    };
    report.is_received = text("source") == "received";
    report.mode = text("mode");
}

void report_access(Connection& connection, ControllerReport& report)
{
    for (const auto& user :
         admin::find_users(connection).value_or(std::vector<UserManagementDataType>{})) {
        if (!admin::is_of_file(user)) {
            report.users.insert(user.user_name.str());
        }
    }
    const auto lists = admin::read_trust_list(connection, admin::trust_list(connection, false));
    for (const auto& each : admin::certificates_of(lists.trusted_certificates)) {
        report.trusted.insert(each.thumbprint_text());
    }
}

NodeId endpoints_exclude(Connection& connection, const std::string& role)
{
    const NodeId roles = standard(id::Server_ServerCapabilities_RoleSet);
    return admin::child_of(connection, admin::child_of(connection, roles, role),
                           "EndpointsExclude");
}

void report_roles(Connection& connection, ControllerReport& report)
{
    std::vector<NamedNode> nodes;
    for (const char* const role : drawn_roles) {
        nodes.push_back({role, endpoints_exclude(connection, role)});
    }
    const auto values = values_of(connection, nodes);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!values[i].value.value_or<bool>(true)) {
            report.closed_roles.insert(drawn_roles[i]);
        }
    }
}

void write_one(Connection& connection, const NodeId& node, Variant value)
{
    WriteRequest request;
    WriteValue item;
    item.node_id = node;
    item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    item.value.value = std::move(value);
    request.nodes_to_write.push_back(item);
    const auto response = connection.call<WriteResponse>(std::move(request), "Write");
    if (response.results.size() != 1 || response.results[0].is_bad()) {
        throw Failure{Exit::Failed, "Write"};
    }
}

void report_status(Connection& connection, ControllerReport& report)
{
    report.restart_reasons = texts_of(fact(connection, "RestartReasons"));
    report.pending_changes = texts_of(fact(connection, "PendingChanges"));
    report.max_sessions =
        admin::read(connection, standard(id::Server_ServerCapabilities_MaxSessions))
            .value_or<std::uint32_t>(0);
    const EndpointDescription* const endpoint = connection.client().endpoint();
    report.application_name =
        endpoint != nullptr ? endpoint->server.application_name.text.str() : std::string{};
}

} // namespace

std::string setting_text(const Variant& value)
{
    if (const auto* const text = value.get_if<String>()) {
        return text->str();
    }
    if (const auto* const flag = value.get_if<bool>()) {
        return *flag ? "true" : "false";
    }
    const auto* const number = value.get_if<std::int64_t>();
    return number != nullptr ? std::to_string(*number) : std::string{};
}

ControllerAdministrator::ControllerAdministrator(std::vector<std::string> ports, std::string pki,
                                                 std::string password)
    : ports_{std::move(ports)}, password_{std::move(password)}
{
    context_.options.pki = std::move(pki);
    context_.options.trusts = true;
    context_.options.is_json = true;
    context_.options.timeout = 60;
}

std::unique_ptr<Connection> ControllerAdministrator::connect(const std::string& user,
                                                             const std::string& password)
{
    context_.options.user = user;
    ::setenv("BUSBAR_PASSWORD", password.c_str(), 1);
    for (std::size_t i = 0;; ++i) {
        try {
            context_.options.url = "opc.tcp://127.0.0.1:" + ports_.front();
            return std::make_unique<Connection>(context_);
        } catch (const Failure& failure) {
            if (failure.exit != Exit::NotConnected || i + 1 >= ports_.size()) {
                throw;
            }
            std::rotate(ports_.begin(), ports_.begin() + 1, ports_.end());
        }
    }
}

Connection& ControllerAdministrator::connection()
{
    if (!connection_) {
        connection_ = connect(chief, password_);
        machine_ = {};
    }
    return *connection_;
}

const NodeId& ControllerAdministrator::machine(Connection& connection)
{
    if (machine_.is_null()) {
        machine_ = find_node(connection, "nsu=urn:busbar:machine;s=Total");
    }
    return machine_;
}

Outcome ControllerAdministrator::tried(const std::function<void(Connection&)>& act)
{
    Connection* connected = nullptr;
    try {
        connected = &connection();
    } catch (const Failure& failure) {
        why_not_ = failure.what();
        return Outcome::Refused; // it was not asked
    }
    try {
        act(*connected);
        return Outcome::Done;
    } catch (const Failure& failure) {
        why_not_ = failure.what() + std::string{" "} + std::string{name(failure.status)};
        if (failure.exit != Exit::NotConnected) {
            return Outcome::Refused;
        }
    }
    disconnect();
    return Outcome::Unknown;
}

std::optional<ControllerReport>
ControllerAdministrator::report(const std::vector<std::string>& settings,
                                const std::vector<std::string>& variables)
{
    ControllerReport report;
    const Outcome outcome = tried([&](Connection& connection) {
        report_settings(connection, settings, report);
        report_values(connection, machine(connection), variables, report);
        report_program(connection, report);
        report_access(connection, report);
        report_roles(connection, report);
        report_status(connection, report);
    });
    return outcome == Outcome::Done ? std::optional{std::move(report)} : std::nullopt;
}

Outcome ControllerAdministrator::set(const std::map<std::string, Variant>& values)
{
    return tried([&](Connection& connection) {
        Array<String> names;
        Array<Variant> wanted;
        for (const auto& [name, value] : values) {
            names.push_back(String{name});
            wanted.push_back(value);
        }
        const NodeId root = settings_of(connection);
        const auto outputs =
            admin::call(connection, root, admin::child_of(connection, root, "Set"),
                        {Variant{std::move(names)}, Variant{std::move(wanted)}}, "Set");
        if (outputs.size() != 2 || !outputs[0].value_or<bool>(false)) {
            throw Failure{Exit::Failed, outputs.size() == 2 ? setting_text(outputs[1])
                                                            : std::string{"no outputs"}};
        }
    });
}

Outcome ControllerAdministrator::add_user(const std::string& name, const std::string& password)
{
    return tried([&](Connection& connection) {
        admin::add_user(connection, name, crypto::Secret{std::string_view{password}}, 0, {});
    });
}

Outcome ControllerAdministrator::change_password(const std::string& name,
                                                 const std::string& password)
{
    return tried([&](Connection& connection) {
        const crypto::Secret secret{std::string_view{password}};
        admin::change_user(connection, name, &secret, std::nullopt);
    });
}

Outcome ControllerAdministrator::remove_user(const std::string& name)
{
    return tried([&](Connection& connection) {
        admin::call(connection, standard(id::UserManagement),
                    standard(id::UserManagement_RemoveUser), {Variant{String{name}}}, "RemoveUser");
    });
}

Outcome ControllerAdministrator::trust(const std::vector<std::byte>& der)
{
    return tried([&](Connection& connection) {
        const auto nodes = admin::trust_list(connection, false);
        admin::call(connection, nodes.object, nodes.add,
                    {Variant{ByteString{std::span{der}}}, Variant{true}}, "AddCertificate");
    });
}

Outcome ControllerAdministrator::distrust(const std::string& thumbprint)
{
    return tried([&](Connection& connection) {
        const auto nodes = admin::trust_list(connection, false);
        admin::call(connection, nodes.object, nodes.remove,
                    {Variant{String{thumbprint}}, Variant{true}}, "RemoveCertificate");
    });
}

Outcome ControllerAdministrator::sent(const char* object, const std::string& wish,
                                      const std::string& file)
{
    return tried([&](Connection& connection) {
        RemoteTransfer transfer{connection, object, {}};
        try {
            transfer.send(Variant{String{wish}}, file);
        } catch (const Failure& failure) {
            if (failure.exit == Exit::NotConnected) {
                throw;
            }
            throw Failure{Exit::Failed,
                          failure.what() + std::string{": "} + transfer.fetch(Variant{"report"})};
        }
    });
}

Outcome ControllerAdministrator::program(const std::string& wish, const std::string& text)
{
    return sent("Program", wish, text);
}

std::optional<std::string> ControllerAdministrator::back_up()
{
    std::string file;
    const Outcome outcome = tried([&](Connection& connection) {
        file = RemoteTransfer{connection, "Backup", {}}.fetch({});
    });
    return outcome == Outcome::Done ? std::optional{std::move(file)} : std::nullopt;
}

Outcome ControllerAdministrator::replace_memory(const std::string& wish, const std::string& backup)
{
    return sent("Backup", wish, backup);
}

Outcome ControllerAdministrator::project(const std::string& wish, const std::string& document)
{
    return sent("Project", wish, document);
}

std::optional<ControllerAdministrator::ProjectReport>
ControllerAdministrator::project_report(const std::string& number)
{
    ProjectReport report;
    const Outcome outcome = tried([&](Connection& connection) {
        RemoteTransfer transfer{connection, "Project", {}};
        const auto status = busbar::detail::parse_json(transfer.fetch(Variant{"status"}));
        const auto* const state = status ? status->find("project") : nullptr;
        report.state = state != nullptr ? state->text : std::string{};
        try {
            report.document = transfer.fetch({});
            report.number =
                admin::read(connection, find_node(connection, number)).value_or<std::int32_t>(-1);
        } catch (const Failure& failure) {
            if (failure.exit == Exit::NotConnected) {
                throw;
            }
        }
    });
    return outcome == Outcome::Done ? std::optional{std::move(report)} : std::nullopt;
}

Outcome ControllerAdministrator::write(const std::string& variable, std::int32_t value)
{
    return tried([&](Connection& connection) {
        const auto of_machine = machine(connection).namespace_index();
        write_one(connection, NodeId{of_machine, String{variable}}, Variant{value});
    });
}

Outcome ControllerAdministrator::close_role(const std::string& role, bool is_closed)
{
    return tried([&](Connection& connection) {
        write_one(connection, endpoints_exclude(connection, role), Variant{!is_closed});
    });
}

Outcome ControllerAdministrator::restart()
{
    return tried([&](Connection& connection) {
        admin::call(connection, standard(id::Server), standard(id::Server_RequestServerStateChange),
                    {Variant{static_cast<std::int32_t>(ServerState::Running)}, Variant{DateTime{}},
                     Variant{std::uint32_t{0}}, Variant{LocalizedText{"", "a test"}},
                     Variant{true}},
                    "RequestServerStateChange");
    });
}

Outcome ControllerAdministrator::forget_own_certificate()
{
    return tried([&](Connection& connection) {
        const NodeId configuration = standard(id::ServerConfiguration);
        admin::call(connection, configuration,
                    admin::child_of(connection, configuration, "DeleteCertificate"),
                    {Variant{NodeId{}}, Variant{standard(id::RsaSha256ApplicationCertificateType)}},
                    "DeleteCertificate");
    });
}

Outcome ControllerAdministrator::reset()
{
    return tried([&](Connection& connection) {
        const NodeId configuration = standard(id::ServerConfiguration);
        admin::call(connection, configuration,
                    admin::child_of(connection, configuration, "ResetToServerDefaults"), {},
                    "ResetToServerDefaults");
    });
}

std::optional<bool> ControllerAdministrator::can_log_in(const std::string& user,
                                                        const std::string& password)
{
    disconnect(); // only one connection at a time
    try {
        static_cast<void>(connect(user, password));
        return true;
    } catch (const Failure& failure) {
        return failure.exit == Exit::Refused ? std::optional{false} : std::nullopt;
    }
}

} // namespace busbar::test
