#include "model_change_events.hpp"

#include <charconv>

#include <busbar/core/text.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "events.hpp"
#include "namespace_nodes.hpp"

namespace busbar::server::detail {

namespace {

/// Returns a version that differs from `present`; increments it if that is a number.
String next_version(const Variant& present)
{
    const auto* const text = present.get_if<String>();
    const std::string_view digits = text == nullptr ? std::string_view{} : text->view();
    std::uint32_t version = 0;
    static_cast<void>(std::from_chars(digits.data(), digits.data() + digits.size(), version));
    return String{std::to_string(version + 1)};
}

/// A property with a data source is the application's responsibility.
void count_up(model::AddressSpace& space, model::NodeIndex property)
{
    if (property != model::no_node && space.variable(property).source == model::no_source) {
        static_cast<void>(space.set_value(property, next_version(space.value(property))));
    }
}

void count_versions_up(model::AddressSpace& space, const model::ModelChanges& taken)
{
    if (!taken.is_complete) {
        space.journal().for_each_node_version(
            [&](model::NodeIndex property) { count_up(space, property); });
        return;
    }
    for (const model::ModelChange& change : taken.changes) {
        const model::NodeIndex node = space.find(change.affected);
        if (node != model::no_node) {
            count_up(space, space.journal().node_version(node));
        }
    }
}

/// Returns an event about the whole address space (Part 5, 6.4.31 and 6.4.33).
Event server_event(const char* message)
{
    Event event;
    event.source_name = "Server";
    event.message = LocalizedText{"en", message};
    return event;
}

/// Returns an event with the changes or, after too many of them, only with the fact that something
/// has changed (Part 3, 9.32.7).
Event change_event(const model::ModelChanges& taken)
{
    Event event = server_event("The address space has changed");
    if (!taken.is_complete) {
        event.event_type = NodeId{0, id::BaseModelChangeEventType};
        return event;
    }
    event.event_type = NodeId{0, id::GeneralModelChangeEventType};
    Array<ExtensionObject> changes;
    changes.reserve(taken.changes.size());
    for (const model::ModelChange& change : taken.changes) {
        changes.push_back(ExtensionObject::from(
            ModelChangeStructureDataType{change.affected, change.affected_type, change.verb}));
    }
    event.set({0, "Changes"}, std::move(changes));
    return event;
}

} // namespace

void ModelChangeEvents::begin()
{
    describe_namespaces();
    static_cast<void>(space_.journal().take_changes());
}

bool ModelChangeEvents::is_pending() const
{
    return space_.journal().has_changes() || namespaces_ != space_.namespace_count();
}

void ModelChangeEvents::announce()
{
    describe_namespaces();
    if (!space_.journal().has_changes()) {
        return;
    }
    const model::ModelChanges taken = space_.journal().take_changes();
    count_versions_up(space_, taken);
    // A small namespace 0 may lack the event type; then no client can ask for it.
    static_cast<void>(events_.raise(change_event(taken)));
}

void ModelChangeEvents::announce_semantics(const NodeId& node)
{
    const model::AddressSpace& space = space_;
    const model::NodeIndex found = space.find(node);
    if (found == model::no_node) {
        return;
    }
    const model::NodeIndex type = space.type_definition(found);
    Array<ExtensionObject> changes;
    changes.push_back(ExtensionObject::from(SemanticChangeStructureDataType{
        node, type == model::no_node ? NodeId{} : space.node_id(type)}));
    Event event = server_event("Properties of a node mean something else");
    event.event_type = NodeId{0, id::SemanticChangeEventType};
    event.set({0, "Changes"}, std::move(changes));
    static_cast<void>(events_.raise(std::move(event)));
}

void ModelChangeEvents::describe_namespaces()
{
    for (; namespaces_ < space_.namespace_count(); ++namespaces_) {
        const auto index = static_cast<std::uint16_t>(namespaces_);
        const auto object = find_or_add_namespace(space_, own_namespace_, index);
        if (!object && object.error() != status::Bad_NotSupported) {
            log_.write(LogLevel::Warning, "server",
                       "Server.Namespaces has nothing on " +
                           printable(space_.namespace_uri(index)) + ": " +
                           std::string{name(object.error())});
        }
    }
}

} // namespace busbar::server::detail
