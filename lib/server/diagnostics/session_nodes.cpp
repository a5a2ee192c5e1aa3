#include "session_nodes.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

#include "describe.hpp"
#include "server/session/session.hpp"
#include "session_fields.hpp"

namespace busbar::server::detail {

namespace {

/// A handle is the entry's number, the part of the Object and the field of that part; field 0 is
/// all of it.
enum class Section : std::uint8_t { Diagnostics, Security, SubscriptionTable };

std::uint64_t handle_of(std::uint32_t number, Section section, std::size_t field)
{
    return std::uint64_t{number} << 16U | static_cast<std::uint64_t>(section) << 8U | field;
}

struct SectionType {
    Section section;
    const char* name;
    /// What it is in the type, whose attributes it has.
    std::uint32_t declaration;
    std::uint32_t type;
    std::span<const FieldName> fields;
};

model::NodeIndex find_component(const model::AddressSpace& space, std::uint32_t type,
                                const QualifiedName& name)
{
    model::NodeIndex found = model::no_node;
    const model::NodeIndex parent = space.find(type);
    if (parent != model::no_node) {
        space.for_each_child(parent, space.find(id::HasComponent), true, name,
                             [&](model::NodeIndex component) {
                                 found = component;
                                 return false;
                             });
    }
    return found;
}

/// A Variable as `declaration` has it; no_node if there is none.
model::NodeIndex add_like(model::AddressSpace& space, model::NodeIndex declaration,
                          model::NewNode node, std::uint32_t type, std::uint64_t handle)
{
    if (declaration == model::no_node) {
        return model::no_node;
    }
    model::NewVariable variable;
    variable.data_type = space.data_type_id(declaration);
    variable.value_rank = space.variable(declaration).value_rank;
    variable.source = live_values_source;
    variable.handle = handle;
    variable.type_definition = NodeId{0, type};
    node.id = NodeId{node.id.namespace_index(), "SessionDiagnostics." + std::to_string(handle)};
    return space.add_variable(node, variable).value_or(model::no_node);
}

/// What only some may see of all sessions only they may see of one.
void protect(model::AddressSpace& space, model::NodeIndex node, Section section)
{
    const model::NodeIndex all = space.find(
        id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray);
    const model::NodeAccess* const access =
        section == Section::Security && all != model::no_node ? space.node_access(all) : nullptr;
    if (access != nullptr && node != model::no_node) {
        space.set_node_access(node, model::NodeAccess{*access});
    }
}

/// The Variable of a part, with one Variable for each field that the part's type has.
void add_part(model::AddressSpace& space, model::NodeIndex object, std::uint16_t name_space,
              std::uint32_t number, const SectionType& part)
{
    model::NewNode node;
    node.id = NodeId{name_space, 0U};
    node.browse_name = QualifiedName{0, part.name};
    node.parent = object;
    node.parent = add_like(space, space.find(part.declaration), node, part.type,
                           handle_of(number, part.section, 0));
    if (node.parent == model::no_node) {
        return;
    }
    protect(space, node.parent, part.section);
    for (std::size_t i = 0; i < part.fields.size(); ++i) {
        node.browse_name = QualifiedName{0, part.fields[i]};
        const auto declaration = find_component(space, part.type, node.browse_name);
        protect(space,
                add_like(space, declaration, node, id::BaseDataVariableType,
                         handle_of(number, part.section, i + 1)),
                part.section);
    }
}

/// Sessions may have the same name, Objects beside each other may not.
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
    const bool is_there = std::any_of(entries_.begin(), entries_.end(), [&](const auto& entry) {
        return entry.second.session == &session;
    });
    model::AddressSpace& space = needs_.space;
    if (is_there || !needs_.counters.is_enabled() ||
        space.find(id::Server_ServerDiagnostics_SessionsDiagnosticsSummary) == model::no_node ||
        space.find(id::SessionDiagnosticsObjectType) == model::no_node) {
        return;
    }
    const auto object = add_object(needs_, session);
    if (!object) {
        return;
    }
    const std::uint32_t number = ++last_number_;
    entries_.emplace(number, Entry{&session, space.handle(*object)});
    const std::array parts{
        SectionType{Section::Diagnostics, "SessionDiagnostics",
                    id::SessionDiagnosticsObjectType_SessionDiagnostics,
                    id::SessionDiagnosticsVariableType, session_field_names()},
        SectionType{Section::Security, "SessionSecurityDiagnostics",
                    id::SessionDiagnosticsObjectType_SessionSecurityDiagnostics,
                    id::SessionSecurityDiagnosticsType, security_field_names()},
        SectionType{Section::SubscriptionTable,
                    "SubscriptionDiagnosticsArray",
                    id::SessionDiagnosticsObjectType_SubscriptionDiagnosticsArray,
                    id::SubscriptionDiagnosticsArrayType,
                    {}},
    };
    for (const SectionType& part : parts) {
        add_part(space, *object, needs_.own_namespace, number, part);
    }
}

void SessionNodes::remove(const Session& session)
{
    std::erase_if(entries_, [&](const auto& entry) {
        if (entry.second.session != &session) {
            return false;
        }
        const model::NodeIndex object = needs_.space.resolve(entry.second.object);
        if (object != model::no_node) {
            static_cast<void>(needs_.space.remove(object));
        }
        return true;
    });
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
    const auto found = entries_.find(static_cast<std::uint32_t>(handle >> 16U));
    if (found == entries_.end()) {
        return fail(status::Bad_NodeIdUnknown);
    }
    const Session& session = *found->second.session;
    const std::size_t field = handle & 0xFF;
    switch (static_cast<Section>(handle >> 8U & 0xFF)) {
    case Section::Diagnostics:
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
