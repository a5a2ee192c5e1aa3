#include <map>
#include <string>

#include <busbar/types/data_types.hpp>

#include "commands.hpp"
#include "lines.hpp"
#include "remote.hpp"
#include "tool/nodes/nodes.hpp"

namespace busbar::tool::admin {

namespace audit {
namespace {

const NodeId event_type{0, id::AuditEventType};

/// False if the server says that this user gets no events; if it does not say, later answers decide
/// (Part 3, 4.9).
bool may_receive(Connection& connection)
{
    const auto permissions =
        read_attributes(connection, event_type, {AttributeId::UserRolePermissions}).front();
    const auto* const roles =
        permissions.status.is_bad() ? nullptr : permissions.value.array_if<ExtensionObject>();
    if (roles == nullptr) {
        return true;
    }
    constexpr auto wanted = static_cast<std::uint32_t>(PermissionType::ReceiveEvents);
    for (const ExtensionObject& each : *roles) {
        const auto* const role = each.get_if<RolePermissionType>();
        if (role != nullptr && (static_cast<std::uint32_t>(role->permissions) & wanted) != 0) {
            return true;
        }
    }
    return false;
}

/// Fails if no events can come: a server does not report events that a user may not see, so the
/// command would wait for ever.
void require_events(Connection& connection)
{
    const Variant auditing = read(connection, standard(id::Server_Auditing));
    if (!auditing.is_null() && !auditing.value_or<bool>(true)) {
        throw Failure{Exit::Failed, "the server raises no audit events, as its Auditing is false",
                      "have it raise them: a busbar-controller does after `busbar admin setting "
                      "set server.auditing true` and a restart"};
    }
    const EndpointDescription* const endpoint = connection.client().endpoint();
    if (endpoint != nullptr && endpoint->security_mode != MessageSecurityMode::SignAndEncrypt) {
        throw Failure{Exit::Refused, "audit events go over encrypted connections only",
                      "connect with --mode SignAndEncrypt"};
    }
    if (!may_receive(connection)) {
        throw Failure{Exit::Refused, "this user may not receive audit events",
                      "log in as one with the role SecurityAdmin"};
    }
}

/// Names of event types, each read once.
class TypeNames {
public:
    explicit TypeNames(Connection& connection) : connection_{&connection} {}

    std::string short_name(const Variant& type)
    {
        const auto* const id = type.get_if<NodeId>();
        if (id == nullptr) {
            return plain_text(type);
        }
        // Forget the names of a server that invents types, to limit the memory.
        constexpr std::size_t most = 1'000;
        if (names_.size() >= most) {
            names_.clear();
        }
        const auto [place, is_new] = names_.try_emplace(*id);
        if (is_new) {
            place->second = ask(*id);
        }
        return place->second;
    }

private:
    std::string ask(const NodeId& type)
    {
        const auto name = read_attributes(*connection_, type, {AttributeId::BrowseName}).front();
        const auto* const qualified = name.value.get_if<QualifiedName>();
        return qualified != nullptr && !name.status.is_bad()
                   ? std::string{admin::short_name(qualified->name.view())}
                   : to_string(type);
    }

    Connection* connection_;
    std::map<NodeId, std::string> names_;
};

Exit follow(Context& context, Connection& connection, const AdminArguments& arguments)
{
    require_events(connection);
    TypeNames names{connection};
    follow_events(context, connection,
                  {.node = to_string(standard(id::Server)),
                   .choice = {.fields = audit_fields(), .type = event_type},
                   .end = arguments.end,
                   .title = audit_title},
                  [&](const EventFields& fields) {
                      const std::string name = names.short_name(fields[4]);
                      context.out.line(
                          audit_line(context.out, name, fields, context.out.columns()));
                  });
    return Exit::Good;
}

} // namespace
} // namespace audit

void add_audit(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    auto* command =
        group.add("audit", "Shows the actions of users at the server as they happen, until Ctrl+C.",
                  0, "URL", audit::follow, Connection::Endurance::Lasting);
    add_stream_options(*command, group.arguments().end);
}

} // namespace busbar::tool::admin
