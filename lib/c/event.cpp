#include <utility>

#include "server.hpp"

using namespace busbar;

namespace busbar::c {

namespace {

/// Replaces `id` by the node that is named, if one is; false if it is malformed.
bool take_id(const char* text, NodeId& id)
{
    if (text == nullptr) {
        return true;
    }
    auto parsed = NodeId::parse(text);
    const bool is_good = parsed.has_value();
    if (is_good) {
        id = *std::move(parsed);
    }
    return is_good;
}

StatusCode raise(server::Server& server, const busbar_event& from)
{
    server::Event event;
    if (from.severity > 1'000) { // Part 5, 6.4.2
        return status::Bad_InvalidArgument;
    }
    if (!take_id(from.type, event.event_type) || !take_id(from.source_node, event.source_node)) {
        return status::Bad_NodeIdInvalid;
    }
    event.source_name = string_of(from.source_name);
    event.message.text = string_of(from.message);
    event.severity = from.severity;
    event.time = DateTime{from.time};
    for (std::size_t i = 0; i < from.field_count; ++i) {
        const busbar_event_field& field = from.fields[i];
        auto value = to_variant(field.value);
        if (!value || field.name == nullptr) {
            return status::Bad_InvalidArgument;
        }
        event.set({field.namespace_index, String{field.name}}, *std::move(value));
    }
    return server.raise_event(std::move(event)) ? status::Good : status::Bad_ResourceUnavailable;
}

} // namespace

} // namespace busbar::c

busbar_status busbar_server_raise_event(busbar_server* server, const busbar_event* event)
{
    if (server == nullptr || event == nullptr || event->size != sizeof *event ||
        !c::has_all(event->fields, event->field_count)) {
        return BUSBAR_BAD_INVALID_ARGUMENT;
    }
    if (server->created.is_bad()) {
        return server->created.value();
    }
    // Without the text, which belongs to the server's thread.
    return c::run_guarded(nullptr, [&] { return c::raise(*server->server, *event); });
}
