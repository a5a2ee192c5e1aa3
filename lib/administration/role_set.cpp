#include "role_set.hpp"

#include <array>
#include <optional>
#include <utility>

#include <busbar/administration/role_set_nodes/nodes.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/model/instance.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/ids.hpp>

#include "method_arguments.hpp"
#include "method_record.hpp"
#include "rights.hpp"

namespace busbar::administration::detail {

namespace {

using model::NodeIndex;
using server::MethodCall;

/// Finds the node of a well-known role (Part 6, Annex A); no_node in a small namespace 0.
NodeIndex well_known_node(const model::AddressSpace& space, std::string_view name)
{
    struct WellKnown {
        std::string_view name;
        std::uint32_t id;
    };
    static constexpr std::array all{
        WellKnown{"Anonymous", id::WellKnownRole_Anonymous},
        WellKnown{"AuthenticatedUser", id::WellKnownRole_AuthenticatedUser},
        WellKnown{"TrustedApplication", id::WellKnownRole_TrustedApplication},
        WellKnown{"Observer", id::WellKnownRole_Observer},
        WellKnown{"Operator", id::WellKnownRole_Operator},
        WellKnown{"Engineer", id::WellKnownRole_Engineer},
        WellKnown{"Supervisor", id::WellKnownRole_Supervisor},
        WellKnown{"ConfigureAdmin", id::WellKnownRole_ConfigureAdmin},
        WellKnown{"SecurityAdmin", id::WellKnownRole_SecurityAdmin},
    };
    for (const WellKnown& each : all) {
        if (each.name == name) {
            return space.find(each.id);
        }
    }
    return model::no_node;
}

} // namespace

RoleSet::RoleSet(server::Server& server, RoleList& roles, NodeTable& table,
                 NodeTable::Signal& changed, LogSink& log,
                 const std::function<Configured<void>()>& may_change)
    : server_{server}, space_{server.address_space()}, roles_{roles}, table_{table},
      changed_{changed}, renew_roles_{table.add_signal(
                             [this] { server::RunningServer{server_}.roles_changed(); })},
      remove_nodes_{table.add_signal([this] { remove_nodes(); })}, log_{log}, may_change_{
                                                                                  may_change}
{
}

Configured<void> RoleSet::attach()
{
    if (space_.find(id::RoleType) == model::no_node ||
        space_.find(id::Server_ServerCapabilities_RoleSet) == model::no_node) {
        log_.write(LogLevel::Info, "administration",
                   "no RoleSet: namespace 0 of this build is too small for it (BUSBAR_NAMESPACE0)");
        return {};
    }
    const auto own = space_.namespace_index(server_.config().application_uri);
    const auto added = space_.add(role_set_nodes::nodes());
    if (!own || !added) {
        return misconfigured("roles", "their nodes cannot be added",
                             added ? StatusCode{status::Bad_ConfigurationError} : added.error());
    }
    own_namespace_ = *own;
    table_.bind_method(space_, space_.find(id::Server_ServerCapabilities_RoleSet_AddRole),
                       [this](MethodCall call) { add_role(std::move(call)); });
    table_.bind_method(space_, space_.find(id::Server_ServerCapabilities_RoleSet_RemoveRole),
                       [this](MethodCall call) { remove_role(std::move(call)); });
    for (const RoleRules& role : roles_.roles()) {
        if (RoleList::is_well_known(role.name)) {
            bind(role.name, well_known_node(space_, role.name));
        } else if (const auto node = add_node(role); !node) {
            return misconfigured("role \"" + printable(role.name) + "\"",
                                 "its node cannot be added", node.error());
        }
    }
    return {};
}

void RoleSet::bind(const std::string& role, NodeIndex node)
{
    bind_values(role, node);
    bind_methods(role, node);
}

void RoleSet::bind_values(const std::string& name, NodeIndex node)
{
    using Make = Variant (*)(const RoleRules&);
    const auto bind_one = [&](std::string_view member, Make make, NodeTable::Setter setter = {}) {
        table_.bind_value(
            space_, child_of(space_, node, member),
            [this, name, make] {
                const RoleRules* const role = roles_.find(name);
                return role != nullptr ? make(*role) : Variant{};
            },
            std::move(setter));
    };
    using Set = Checked<void> (RoleList::*)(std::string_view, bool);
    const auto setter = [&](Set set) {
        return [this, name, set](const DataValue& value) {
            if (const auto refusal = refusal_of(may_change_)) {
                return refusal->status;
            }
            const auto done = (roles_.*set)(name, value.value.value_or<bool>(true));
            if (!done) {
                return done.error().status;
            }
            table_.raise(renew_roles_);
            table_.raise(changed_);
            return status::Good;
        };
    };
    table_.bind_value(space_, child_of(space_, node, "Identities"), [this, name] {
        return structures<IdentityMappingRuleType>(roles_.identities_of(name));
    });
    bind_one("Applications", [](const RoleRules& role) { return texts(role.applications); });
    bind_one("Endpoints",
             [](const RoleRules& role) { return structures<EndpointType>(role.endpoints); });
    bind_one(
        "ApplicationsExclude",
        [](const RoleRules& role) { return Variant{role.applications_exclude}; },
        setter(&RoleList::set_applications_exclude));
    bind_one(
        "EndpointsExclude", [](const RoleRules& role) { return Variant{role.endpoints_exclude}; },
        setter(&RoleList::set_endpoints_exclude));
    // Roles consist of rules only.
    bind_one("CustomConfiguration", [](const RoleRules&) { return Variant{false}; });
}

void RoleSet::bind_methods(const std::string& name, NodeIndex node)
{
    bind_change(node, "AddIdentity", [this, name](const MethodCall& call) {
        return roles_.add_identity(name, structure_input<IdentityMappingRuleType>(call));
    });
    bind_change(node, "RemoveIdentity", [this, name](const MethodCall& call) {
        return roles_.remove_identity(name, structure_input<IdentityMappingRuleType>(call));
    });
    bind_change(node, "AddApplication", [this, name](const MethodCall& call) {
        return roles_.add_application(name, text_input(call, 0));
    });
    bind_change(node, "RemoveApplication", [this, name](const MethodCall& call) {
        return roles_.remove_application(name, text_input(call, 0));
    });
    bind_change(node, "AddEndpoint", [this, name](const MethodCall& call) {
        return roles_.add_endpoint(name, structure_input<EndpointType>(call));
    });
    bind_change(node, "RemoveEndpoint", [this, name](const MethodCall& call) {
        return roles_.remove_endpoint(name, structure_input<EndpointType>(call));
    });
}

void RoleSet::bind_change(NodeIndex node, std::string_view method, Change change)
{
    table_.bind_method(space_, child_of(space_, node, method),
                       [this, change = std::move(change)](MethodCall call) {
                           if (is_refused(call)) {
                               return;
                           }
                           const Checked<void> done = change(call);
                           if (!done) {
                               return refuse_call(call, done.error());
                           }
                           changed(call);
                           call.succeed();
                       });
}

void RoleSet::changed(const MethodCall& call)
{
    tell_method(log_, RecordKind::RolesChanged, call, status::Good, nullptr);
    table_.raise(renew_roles_);
    table_.raise(changed_);
}

void RoleSet::refuse_call(MethodCall& call, const Refusal& refusal)
{
    tell_method(log_, RecordKind::RolesChanged, call, refusal.status, &refusal);
    answer_with(call, refusal);
}

bool RoleSet::is_refused(MethodCall& call)
{
    const auto refusal = refusal_of(may_change_);
    if (refusal) {
        refuse_call(call, *refusal);
    }
    return refusal.has_value();
}

NodeId RoleSet::node_id(const RoleRules& role) const
{
    return NodeId{own_namespace_, "RoleSet/" + role.namespace_uri + "/" + role.name};
}

Result<NodeIndex> RoleSet::add_node(const RoleRules& role)
{
    const auto name_space = space_.namespace_index(role.namespace_uri);
    model::NewNode node;
    node.id = node_id(role);
    // The namespace may be missing if its model is no longer loaded.
    node.browse_name = QualifiedName{name_space.value_or(own_namespace_), String{role.name}};
    node.parent = space_.find(id::Server_ServerCapabilities_RoleSet);
    model::InstanceOptions options;
    options.all_optional = true;
    options.methods = model::InstanceMethods::Copied;
    const auto made = model::instantiate(space_, node, space_.find(id::RoleType), options);
    if (!made) {
        return made;
    }
    give_rights(space_, *made, Thing::Roles, Authorities::Standard); // it is the same with all
                                                                     // Authorities
    bind(role.name, *made);
    return made;
}

/// Part 18, 4.2.2.
void RoleSet::add_role(MethodCall call)
{
    if (is_refused(call)) {
        return;
    }
    const std::string name = text_input(call, 0);
    const std::string uri = text_input(call, 1);
    if (!uri.empty() && !space_.namespace_index(uri)) {
        return refuse_call(call, {status::Bad_InvalidArgument,
                                  "role set",
                                  "the server has no namespace " + printable(uri),
                                  "Part 18, 4.2.2",
                                  {}});
    }
    if (const auto added = roles_.add(name, uri); !added) {
        return refuse_call(call, added.error());
    }
    const RoleRules& role = *roles_.find(name);
    busbar::detail::Undo undo{[&] {
        const NodeIndex node = space_.find(node_id(role));
        static_cast<void>(roles_.remove(name));
        if (node != model::no_node) {
            static_cast<void>(space_.remove(node));
        }
    }};
    if (const auto node = add_node(role); !node) {
        return call.fail(node.error(), "the role's nodes cannot be added");
    }
    auto outputs = one_output(Variant{node_id(role)});
    undo.keep();
    changed(call);
    call.succeed(std::move(outputs));
}

void RoleSet::remove_nodes()
{
    for (; !gone_.empty(); gone_.pop_back()) {
        if (const NodeIndex node = space_.find(gone_.back()); node != model::no_node) {
            static_cast<void>(space_.remove(node));
        }
    }
}

/// Part 18, 4.2.3.
void RoleSet::remove_role(MethodCall call)
{
    if (is_refused(call)) {
        return;
    }
    const NodeId id = call.input<NodeId>(0);
    const NodeIndex node = space_.find(id);
    std::string name;
    for (const RoleRules& role : roles_.roles()) {
        const bool is_it = RoleList::is_well_known(role.name)
                               ? well_known_node(space_, role.name) == node
                               : node_id(role) == id;
        name = is_it ? role.name : name;
    }
    if (node == model::no_node || name.empty()) {
        return refuse_call(call, {status::Bad_NodeIdUnknown,
                                  "role set",
                                  printable(to_string(id)) + " is not a role of this server",
                                  "Part 18, 4.2.3",
                                  {}});
    }
    gone_.push_back(id);
    busbar::detail::Undo undo{[this] { gone_.pop_back(); }};
    if (const auto removed = roles_.remove(name); !removed) {
        return refuse_call(call, removed.error());
    }
    undo.keep();
    table_.raise(remove_nodes_); // later, because a Method of the node may be running
    changed(call);
    call.succeed();
}

} // namespace busbar::administration::detail
