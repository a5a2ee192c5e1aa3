#include <algorithm>
#include <utility>

#include <busbar/types/ids.hpp>

#include "server.hpp"
#include "variable_source.hpp"

namespace busbar::c {

namespace {

/// Says where a variable's value comes from, and the handle that its program gets.
struct Binding {
    std::uint32_t source{0};
    std::uint64_t handle{0};
    bool is_new{false}; // of VariableSource
    bool is_kept{false};
};

/// Adds the variable to what serves it. Bad_NotFound for a source that was not added.
Result<Binding> bind_to(busbar_server& server, const busbar_variable& variable, const NodeId& id,
                        Variant value)
{
    Binding binding;
    if (variable.source != 0) {
        if (std::ranges::find(server.sources, variable.source) == server.sources.end()) {
            return fail(status::Bad_NotFound);
        }
        binding.source = variable.source;
        binding.handle = variable.handle;
        return binding;
    }
    VariableSource::Entry entry;
    entry.id = id;
    entry.id_text = to_string(id);
    entry.read = variable.read;
    entry.write = variable.write;
    entry.context = variable.context;
    binding.is_kept = entry.read == nullptr && entry.write == nullptr;
    entry.kept = DataValue{std::move(value), status::Good, server.around.clock().now()};
    binding.source = server.variables->index();
    binding.handle = server.variables->add(std::move(entry));
    binding.is_new = true;
    return binding;
}

bool is_complete(const busbar_variable* variable)
{
    return variable != nullptr && variable->size == sizeof *variable &&
           (variable->source == 0 || (variable->read == nullptr && variable->write == nullptr));
}

model::Access access_of(const busbar_variable& variable)
{
    return variable.is_writable ? model::Access::ReadWrite : model::Access::Read;
}

StatusCode add_one(busbar_server& server, const busbar_variable& variable, std::uint64_t& handle)
{
    model::AddressSpace& space = server.server->address_space();
    const auto node = new_node_of(space, variable.node, id::ObjectsFolder);
    auto value = to_variant(variable.value);
    if (!node || !value) {
        return node ? value.error() : node.error();
    }
    model::NewVariable made;
    if (const StatusCode shaped = set_shape(space, *value, made); shaped.is_bad()) {
        return shaped;
    }
    if (variable.data_type != nullptr) {
        auto type = NodeId::parse(variable.data_type);
        if (!type) {
            return status::Bad_NodeAttributesInvalid;
        }
        made.data_type = *std::move(type);
    }
    const auto binding = bind_to(server, variable, node->id, *std::move(value));
    if (!binding) {
        return binding.error();
    }
    busbar::detail::Undo undo{[&] {
        if (binding->is_new) {
            server.variables->remove(binding->handle);
        }
    }};
    made.source = binding->source;
    made.handle = binding->handle;
    made.access_level = access_of(variable);
    const auto added = variable.is_property ? space.add_property(*node, std::move(made))
                                            : space.add_variable(*node, made);
    if (!added) {
        return added.error();
    }
    undo.keep();
    handle = binding->is_kept ? binding->handle : 0;
    return status::Good;
}

StatusCode bind_one(busbar_server& server, const busbar_variable& variable, std::uint64_t& handle)
{
    model::AddressSpace& space = server.server->address_space();
    const auto id = node_id_of(variable.node.id);
    const model::NodeIndex node = id ? space.find(*id) : model::no_node;
    if (node == model::no_node || space.node_class(node) != NodeClass::Variable) {
        return status::Bad_NodeIdUnknown;
    }
    auto value = to_variant(variable.value);
    if (!value) {
        return value.error();
    }
    const model::VariableAttributes is = space.variable(node);
    if (value->is_null()) {
        *value = space.value(node);
    } else if (const StatusCode checked =
                   space.check_value(*value, is.data_type, is.value_rank, is.array_dimensions);
               checked.is_bad()) {
        return checked;
    }
    const auto binding = bind_to(server, variable, *id, *std::move(value));
    if (!binding) {
        return binding.error();
    }
    busbar::detail::Undo undo{[&] {
        if (binding->is_new) {
            server.variables->remove(binding->handle);
        }
    }};
    space.bind(node, binding->source, binding->handle);
    undo.keep();
    if (is.source == server.variables->index()) {
        server.variables->remove(is.handle); // nothing asks for it any more
    }
    space.set_access_level(node, access_of(variable));
    handle = binding->is_kept ? binding->handle : 0;
    return status::Good;
}

using PutVariable = StatusCode (*)(busbar_server&, const busbar_variable&, std::uint64_t&);

busbar_status put(busbar_server* server, const busbar_variable* variable, std::uint64_t* handle,
                  PutVariable how)
{
    return change(server, [&]() -> StatusCode {
        if (!is_complete(variable)) {
            return status::Bad_InvalidArgument;
        }
        std::uint64_t unused = 0;
        return how(*server, *variable, handle != nullptr ? *handle : unused);
    });
}

/// A variable that is kept in memory, with its node; without an entry if the handle has none.
struct KeptVariable {
    VariableSource::Entry* entry{nullptr};
    model::NodeIndex node{model::no_node};
};

/// Finds what a handle stands for: the node has to be there still, and be bound to the entry.
KeptVariable kept(busbar_server& server, std::uint64_t handle)
{
    VariableSource::Entry* const entry = server.variables->kept(handle);
    if (entry == nullptr) {
        return {};
    }
    const model::AddressSpace& space = server.server->address_space();
    const model::NodeIndex node = space.find(entry->id);
    if (node == model::no_node || space.node_class(node) != NodeClass::Variable) {
        return {};
    }
    const model::VariableAttributes is = space.variable(node);
    return is.source == server.variables->index() && is.handle == handle ? KeptVariable{entry, node}
                                                                         : KeptVariable{};
}

} // namespace

} // namespace busbar::c

using namespace busbar;

void busbar_variable_init(busbar_variable* variable)
{
    if (variable != nullptr) {
        *variable = busbar_variable{};
        variable->size = sizeof *variable;
    }
}

busbar_status busbar_server_add_variable(busbar_server* server, const busbar_variable* variable,
                                         uint64_t* handle)
{
    return c::put(server, variable, handle, c::add_one);
}

busbar_status busbar_server_bind_variable(busbar_server* server, const busbar_variable* variable,
                                          uint64_t* handle)
{
    return c::put(server, variable, handle, c::bind_one);
}

busbar_status busbar_server_set_value(busbar_server* server, uint64_t handle,
                                      const busbar_value* value, busbar_status status,
                                      busbar_time time)
{
    return c::enter(server, [&]() -> StatusCode {
        if (value == nullptr) {
            return status::Bad_InvalidArgument;
        }
        const auto [entry, node] = c::kept(*server, handle);
        if (entry == nullptr) {
            return status::Bad_NotFound;
        }
        auto made = c::to_variant(*value);
        if (!made) {
            return made.error();
        }
        const model::AddressSpace& space = server->server->address_space();
        const model::VariableAttributes is = space.variable(node);
        if (const StatusCode checked =
                space.check_value(*made, is.data_type, is.value_rank, is.array_dimensions);
            checked.is_bad()) {
            return checked;
        }
        server->variables->keep(*entry,
                                DataValue{*std::move(made), StatusCode{status}, DateTime{time}});
        return status::Good;
    });
}

busbar_status busbar_server_get_value(busbar_server* server, uint64_t handle,
                                      busbar_data_value* value)
{
    return c::enter(server, [&]() -> StatusCode {
        const c::VariableSource::Entry* const entry = c::kept(*server, handle).entry;
        if (value == nullptr || entry == nullptr) {
            return value == nullptr ? status::Bad_InvalidArgument : status::Bad_NotFound;
        }
        server->scratch.clear();
        static_cast<void>(c::to_c(entry->kept, server->scratch, *value));
        return status::Good;
    });
}
