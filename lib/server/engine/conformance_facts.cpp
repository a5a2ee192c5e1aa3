#include "conformance_facts.hpp"

#include <algorithm>
#include <array>

#include <busbar/types/ids.hpp>

#include "core.hpp"
#include "server/rights/method_lookup.hpp"
#include "server/users/user_policies.hpp"

namespace busbar::server::detail {

namespace {

/// A node that only namespaces 0 of this size and above have.
struct SizeMark {
    std::uint32_t node;
    Namespace0Size size;
};

constexpr std::array size_marks{
    SizeMark{id::RationalNumber, Namespace0Size::Full},
    SizeMark{id::AnalogItemType, Namespace0Size::Standard},
    SizeMark{id::Server_ServerDiagnostics, Namespace0Size::Embedded},
    SizeMark{id::Server, Namespace0Size::Micro},
};

Namespace0Size size_of_namespace0(const model::SpaceReader& space)
{
    const auto* const found =
        std::find_if(size_marks.begin(), size_marks.end(),
                     [&](const SizeMark& mark) { return space.find(mark.node) != model::no_node; });
    return found != size_marks.end() ? found->size : Namespace0Size::None;
}

bool has_service(const Core& core, std::uint32_t request)
{
    const Service* service = core.services.find(NodeId{0, request});
    return service != nullptr && service->run != nullptr;
}

void add_modules(ConformanceFacts& facts, const Core& core)
{
    facts.methods = core.methods != nullptr;
    facts.events = core.events->queue() != nullptr;
    facts.node_management = core.node_management != nullptr && core.config.has_node_management;
    facts.diagnostics = core.server_object.has_others();
    facts.audit = facts.events && core.config.is_auditing;
    const auto has_method = [&](std::uint32_t id) {
        const model::NodeIndex method = core.address_space.find(id);
        return method != model::no_node && is_executable(core.address_space, method);
    };
    facts.roles = has_method(id::Server_ServerCapabilities_RoleSet_AddRole);
    facts.push = has_method(id::ServerConfiguration_ApplyChanges);
    facts.state_change = has_method(id::Server_RequestServerStateChange);
    facts.user_management = has_method(id::UserManagement_AddUser);
    facts.triggering = has_service(core, id::SetTriggeringRequest_Encoding_DefaultBinary);
    facts.transfer = has_service(core, id::TransferSubscriptionsRequest_Encoding_DefaultBinary);
}

void add_users(ConformanceFacts& facts, const EndpointConfig& endpoint, UserStore* users)
{
    const auto lets_in = [&](UserTokenType type) { return accepts(endpoint, users, type); };
    const bool has_secrets =
        lets_in(UserTokenType::UserName) || lets_in(UserTokenType::IssuedToken);
    facts.users_anonymous |= lets_in(UserTokenType::Anonymous);
    facts.users_password |= lets_in(UserTokenType::UserName);
    facts.users_certificate |= lets_in(UserTokenType::Certificate);
    facts.users_issued |= lets_in(UserTokenType::IssuedToken);
    facts.users_unencrypted |= has_secrets && password_policy(endpoint).is_none();
}

void add_policy(ConformanceFacts& facts, const crypto::SecurityPolicy& policy)
{
    facts.policy_none |= policy.is_none();
    facts.policy_basic256sha256 |= policy.name == "Basic256Sha256";
    facts.policy_aes128 |= policy.name == "Aes128_Sha256_RsaOaep";
    facts.policy_aes256 |= policy.name == "Aes256_Sha256_RsaPss";
}

/// The maximum numbers of sessions in a profile, and of Subscriptions of each; half of the sessions
/// must be able to use the maximum at a time (Part 7, Subscription Minimum, Monitor Items).
constexpr std::size_t sessions_of_profile = 50;
constexpr std::size_t subscriptions_of_profile = 5;

constexpr std::size_t half_of(std::size_t count)
{
    return std::max<std::size_t>((count + 1) / 2, 1);
}

void add_limits(ConformanceFacts& facts, const ServerLimits& limits)
{
    const SubscriptionLimits& own = limits.subscriptions;
    const std::size_t sharing = half_of(std::min(limits.max_sessions, sessions_of_profile));
    facts.sessions = limits.max_sessions;
    facts.channels = limits.max_connections;
    facts.subscriptions =
        std::min({own.max_subscriptions_per_session, own.max_subscriptions_per_user,
                  own.max_subscriptions / sharing});
    const std::size_t each = half_of(std::min(facts.subscriptions, subscriptions_of_profile));
    facts.items = std::min({own.max_items_per_subscription, own.max_items_per_user / each,
                            own.max_items / (sharing * each)});
    facts.publish = own.max_publish_requests;
    facts.queue = own.max_queue_size;
    facts.continuation_points = limits.max_browse_continuation_points;
}

bool is_of_type(const model::SpaceReader& space, model::NodeIndex node)
{
    model::ReferenceCursor references = space.references(node);
    while (const auto reference = references.next()) {
        if (reference->is_forward && space.is_subtype_of(reference->type, id::HasModellingRule)) {
            return true;
        }
    }
    return false;
}

/// Returns the types of nodes beyond namespace 0, without those of instance declarations.
std::vector<model::NodeIndex> types_in_use(const model::SpaceReader& space)
{
    std::vector<model::NodeIndex> types;
    space.for_each([&](model::NodeIndex node) {
        if (space.node_id(node).namespace_index() == 0) { // most nodes of a small server
            return;
        }
        const model::NodeIndex type = space.type_definition(node);
        if (type == model::no_node) {
            return;
        }
        const auto place = std::lower_bound(types.begin(), types.end(), type);
        if ((place == types.end() || *place != type) && !is_of_type(space, node)) {
            types.insert(place, type);
        }
    });
    return types;
}

/// NodeVersion, which is no type, stands for itself: without one on some node no change of the
/// model is told (Part 3, 9.32.2).
std::vector<std::uint32_t> instance_types(const model::AddressSpace& space)
{
    std::vector<std::uint32_t> all;
    space.journal().for_each_node_version([&](model::NodeIndex version) {
        if (space.node_id(version).namespace_index() != 0 && all.empty()) {
            all.push_back(id::NodeVersion);
        }
    });
    for (model::NodeIndex type : types_in_use(space)) {
        for (; type != model::no_node; type = space.supertype(type)) {
            const NodeId node = space.node_id(type);
            if (node.namespace_index() == 0 && node.is_numeric()) {
                all.push_back(node.numeric());
            }
        }
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

} // namespace

ConformanceFacts conformance_facts(const Core& core)
{
    ConformanceFacts facts;
    facts.namespace0 = size_of_namespace0(core.address_space);
    add_modules(facts, core);
    for (const EndpointConfig& endpoint : core.config.endpoints) {
        add_users(facts, endpoint, core.environment.users);
        add_policy(facts, *endpoint.security.policy);
    }
    add_limits(facts, core.limits());
    facts.tcp = true; // a Connection speaks it, whatever carries the bytes
    facts.reverse_connect = core.config.program.has_reverse_connect;
    facts.discovery = core.config.program.has_registration;
    facts.declared_units = core.config.program.conformance_units;
    facts.instance_types = instance_types(core.address_space);
    return facts;
}

} // namespace busbar::server::detail
