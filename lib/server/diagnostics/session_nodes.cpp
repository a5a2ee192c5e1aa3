#include "session_nodes.hpp"

#include <string>
#include <utility>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

#include "describe.hpp"
#include "part_nodes.hpp"
#include "server/session/session.hpp"
#include "server/subscription/subscription.hpp"

namespace busbar::server::detail {

namespace {

/// Returns the access rules of the security diagnostics, which apply to single sessions as well;
/// null if there are none.
const model::NodeAccess* access_to_security(const model::AddressSpace& space)
{
    const model::NodeIndex all = space.find(
        id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray);
    return all == model::no_node ? nullptr : space.node_access(all);
}

/// Adds a reference from the array to one of its elements (Part 5, 7.13 and 7.16).
void add_to_array(model::AddressSpace& space, std::uint32_t array, model::NodeIndex element)
{
    const model::NodeIndex from = space.find(array);
    if (from != model::no_node && element != model::no_node) {
        static_cast<void>(space.add_reference(from, NodeId{0, id::HasComponent}, element));
    }
}

PartNodes session_part(const model::AddressSpace& space)
{
    return {.section = Section::Session,
            .name = "SessionDiagnostics",
            .declaration = space.find(id::SessionDiagnosticsObjectType_SessionDiagnostics),
            .type = id::SessionDiagnosticsVariableType,
            .fields = session_field_names()};
}

PartNodes security_part(const model::AddressSpace& space)
{
    return {.section = Section::Security,
            .name = "SessionSecurityDiagnostics",
            .declaration = space.find(id::SessionDiagnosticsObjectType_SessionSecurityDiagnostics),
            .type = id::SessionSecurityDiagnosticsType,
            .fields = security_field_names(),
            .access = access_to_security(space)};
}

/// Sessions may have the same name, Objects below one parent may not.
Result<model::NodeIndex> add_object(const DiagnosticsNeeds& needs, const Session& session)
{
    model::NewNode node;
    node.id = session.id;
    node.browse_name = QualifiedName{needs.own_namespace, session.name};
    node.parent = needs.space.find(id::Server_ServerDiagnostics_SessionsDiagnosticsSummary);
    const model::NewObject object{NodeId{0, id::SessionDiagnosticsObjectType}};
    auto made = needs.space.add_object(node, object);
    if (!made && made.error() == status::Bad_BrowseNameDuplicated) {
        node.display_name = LocalizedText{String{session.name}};
        node.browse_name.name = session.name + " " + to_string(session.id);
        made = needs.space.add_object(node, object);
    }
    return made;
}

} // namespace

void SessionNodes::add(const Session& session)
{
    model::AddressSpace& space = needs_.space;
    if (numbers_.contains(&session) || !needs_.counters.is_enabled() ||
        space.find(id::Server_ServerDiagnostics_SessionsDiagnosticsSummary) == model::no_node ||
        space.find(id::SessionDiagnosticsObjectType) == model::no_node) {
        return;
    }
    const auto object = add_object(needs_, session);
    if (!object) {
        return;
    }
    busbar::detail::Undo removed_object{[&] { static_cast<void>(space.remove(*object)); }};
    const std::uint32_t number = ++last_number_;
    numbers_.emplace(&session, number);
    busbar::detail::Undo forgotten{[&] {
        entries_.erase(number);
        numbers_.erase(&session);
    }};
    entries_.emplace(number, Entry{&session, space.handle(*object), {}});
    const auto add = [&](const PartNodes& part) {
        return add_part(space, *object, needs_.own_namespace, number, part);
    };
    add_to_array(space,
                 id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray,
                 add(session_part(space)));
    add_to_array(
        space,
        id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray,
        add(security_part(space)));
    const model::NodeIndex subscriptions = add(
        {.section = Section::SubscriptionTable,
         .name = "SubscriptionDiagnosticsArray",
         .declaration = space.find(id::SessionDiagnosticsObjectType_SubscriptionDiagnosticsArray),
         .type = id::SubscriptionDiagnosticsArrayType,
         .fields = {}});
    if (subscriptions != model::no_node) {
        entries_.at(number).subscriptions = space.handle(subscriptions);
    }
    forgotten.keep();
    removed_object.keep();
}

std::size_t SessionNodes::add_fields(model::NodeIndex variable, std::uint64_t handle)
{
    const auto found = entries_.find(number_of(handle));
    const Section section = section_of(handle);
    if (found == entries_.end() || field_of(handle) != 0 ||
        (section != Section::Session && section != Section::Security)) {
        return 0;
    }
    const bool is_session = section == Section::Session;
    bool& has_fields =
        is_session ? found->second.has_session_fields : found->second.has_security_fields;
    if (has_fields) {
        return 0;
    }
    const std::size_t count =
        detail::add_fields(needs_.space, variable, needs_.own_namespace, number_of(handle),
                           is_session ? session_part(needs_.space) : security_part(needs_.space));
    has_fields = true;
    return count;
}

model::NodeIndex SessionNodes::subscriptions_of(const Session& session) const
{
    const auto number = numbers_.find(&session);
    return number == numbers_.end()
               ? model::no_node
               : needs_.space.resolve(entries_.at(number->second).subscriptions);
}

void SessionNodes::remove(const Session& session)
{
    const auto number = numbers_.find(&session);
    if (number == numbers_.end()) {
        return;
    }
    entries_.at(number->second).session = nullptr;
    numbers_.erase(number);
    ++left_;
    remove_left();
}

void SessionNodes::remove_left()
{
    for (auto entry = entries_.begin(); left_ != 0 && entry != entries_.end();) {
        if (entry->second.session != nullptr) {
            ++entry;
            continue;
        }
        const model::NodeIndex object = needs_.space.resolve(entry->second.object);
        const StatusCode thrown = busbar::detail::caught([&] {
            if (object != model::no_node) {
                static_cast<void>(needs_.space.remove(object));
            }
        });
        if (thrown.is_bad()) { // added with the next one
            return;
        }
        entry = entries_.erase(entry);
        --left_;
    }
}

void SessionNodes::take_flag()
{
    if (std::exchange(is_shown_, needs_.counters.is_enabled()) == needs_.counters.is_enabled()) {
        return;
    }
    for (const auto& [token, session] : needs_.sessions.all()) {
        if (!is_shown_) {
            remove(*session);
        } else if (session->is_activated) {
            add(*session);
        }
    }
}

Result<Variant> SessionNodes::value(std::uint64_t handle, const ReadingUser& reader) const
{
    const std::uint32_t number = number_of(handle);
    const Section section = section_of(handle);
    const std::size_t field = field_of(handle);
    if (section == Section::Subscription) {
        const Subscription* const subscription = needs_.subscriptions.find(number);
        return subscription == nullptr
                   ? Result<Variant>{fail(status::Bad_NodeIdUnknown)}
                   : Result<Variant>{subscription_field(
                         describe_subscription(needs_.counters, *subscription), field)};
    }
    const auto found = entries_.find(number);
    if (found == entries_.end() || found->second.session == nullptr) {
        return fail(status::Bad_NodeIdUnknown);
    }
    const Session& session = *found->second.session;
    switch (section) {
    case Section::Session:
        return session_field(describe_session(needs_.counters, session), field);
    case Section::Security:
        if (!reader.may_see_security()) {
            return fail(status::Bad_UserAccessDenied);
        }
        return security_field(describe_security(session), field);
    default:
        return describe_subscriptions(needs_.counters, session);
    }
}

} // namespace busbar::server::detail
