#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <busbar/server/method_table.hpp>
#include <busbar/types/ids.hpp>

#include "core/utf8.hpp"
#include "server.hpp"
#include "variable_source.hpp"

namespace busbar::c {

namespace {

/// The NodeId of a node that was given none: its path below nodes with such NodeIds.
NodeId path_of(const NodeId& parent, std::uint16_t index, std::string_view name)
{
    std::string path;
    if (parent.id_type() == IdType::String && parent.namespace_index() == index) {
        path = parent.string().str() + "/";
    }
    return NodeId{index, String{path.append(name)}};
}

model::NodeIndex find_node(const model::AddressSpace& space, const char* text)
{
    const auto id = node_id_of(text);
    return id ? space.find(*id) : model::no_node;
}

/// The entries and functions of nodes that are removed; they are freed after the nodes.
class ServedNodes {
public:
    ServedNodes(busbar_server& server, model::NodeIndex node) : server_{&server}
    {
        server.server->address_space().for_each_below(node, [&](model::NodeIndex each) {
            take(each);
            return true;
        });
    }
    void free() noexcept
    {
        for (const std::uint64_t handle : variables_) {
            server_->variables->remove(handle);
        }
        for (const std::uint64_t handle : methods_) {
            server_->methods->remove(handle);
        }
    }

private:
    void take(model::NodeIndex node)
    {
        const model::AddressSpace& space = server_->server->address_space();
        const NodeClass node_class = space.node_class(node);
        if (node_class == NodeClass::Variable) {
            const model::VariableAttributes is = space.variable(node);
            if (is.source == server_->variables->index()) {
                variables_.push_back(is.handle);
            }
        } else if (node_class == NodeClass::Method) {
            const model::MethodAttributes is = space.method(node);
            if (is.source == server_->methods->index()) {
                methods_.push_back(is.handle);
            }
        }
    }

    busbar_server* server_;
    std::vector<std::uint64_t> variables_;
    std::vector<std::uint64_t> methods_;
};

StatusCode check_properties(std::span<const busbar_property> properties)
{
    std::vector<std::string_view> names;
    for (const busbar_property& each : properties) {
        if (each.name == nullptr || built_in_type_id(each.type).is_null()) {
            return status::Bad_InvalidArgument;
        }
        names.emplace_back(each.name);
    }
    std::ranges::sort(names);
    const auto is_invalid = [](std::string_view name) {
        return name.empty() || name.size() > busbar::detail::max_browse_name;
    };
    if (std::ranges::any_of(names, is_invalid)) {
        return status::Bad_BrowseNameInvalid;
    }
    const bool is_double = std::ranges::adjacent_find(names) != names.end();
    return is_double ? status::Bad_BrowseNameDuplicated : status::Good;
}

/// Adds the Properties of a type, each with the parent's NodeId in its own.
StatusCode add_properties(model::AddressSpace& space, model::NodeIndex type,
                          std::uint16_t namespace_index,
                          std::span<const busbar_property> properties)
{
    for (const busbar_property& each : properties) {
        model::NewVariable variable;
        variable.data_type = built_in_type_id(each.type);
        variable.value_rank = each.is_array ? 1 : -1;
        model::NewNode node;
        node.browse_name.namespace_index = namespace_index;
        node.browse_name.name = String{each.name};
        node.parent = type;
        const auto property = space.add_property(node, std::move(variable));
        if (!property) {
            return property.error();
        }
        // Events are instances of the type, which have what is Mandatory (Part 3, 6.4.4).
        const auto rule = space.add_reference(*property, NodeId{0, id::HasModellingRule},
                                              space.find(id::ModellingRule_Mandatory));
        if (!rule && space.find(id::ModellingRule_Mandatory) != model::no_node) {
            return rule.error();
        }
    }
    return status::Good;
}

} // namespace

Result<model::NewNode> new_node_of(const model::AddressSpace& space, const busbar_node& node,
                                   std::uint32_t folder)
{
    if (node.name == nullptr) {
        return fail(status::Bad_BrowseNameInvalid);
    }
    model::NewNode made;
    made.parent = node.parent != nullptr ? find_node(space, node.parent) : space.find(folder);
    if (made.parent == model::no_node) {
        return fail(status::Bad_ParentNodeIdInvalid);
    }
    auto id = node.id != nullptr
                  ? NodeId::parse(node.id)
                  : path_of(space.node_id(made.parent), node.namespace_index, node.name);
    if (!id) {
        return fail(id.error());
    }
    made.id = *std::move(id);
    made.browse_name = {node.namespace_index, String{node.name}};
    made.display_name.text = string_of(node.display_name);
    made.description.text = string_of(node.description);
    return made;
}

NodeId built_in_type_id(std::uint8_t type)
{
    // The NodeIds of the built-in types are their numbers (Part 6, 5.1.2); a structure is
    // Structure.
    return type > BUSBAR_NULL && type <= BUSBAR_EXTENSION_OBJECT ? NodeId{0, std::uint32_t{type}}
                                                                 : NodeId{};
}

StatusCode set_shape(const model::AddressSpace& space, const Variant& like,
                     model::NewVariable& variable)
{
    if (like.is_null()) {
        return status::Bad_NodeAttributesInvalid;
    }
    const model::NodeIndex type = space.type_of_value(like);
    if (type == model::no_node) {
        return status::Bad_NodeAttributesInvalid;
    }
    variable.data_type = space.node_id(type);
    variable.value_rank = -1;
    if (like.is_matrix()) {
        variable.value_rank = static_cast<std::int32_t>(like.dimensions().size());
        variable.array_dimensions = Array<std::uint32_t>{like.dimensions()};
    } else if (like.is_array()) {
        variable.value_rank = 1;
        if (like.array_size() != 0) {
            variable.array_dimensions = {static_cast<std::uint32_t>(like.array_size())};
        }
    }
    return status::Good;
}

} // namespace busbar::c

using namespace busbar;

busbar_status busbar_server_add_namespace(busbar_server* server, const char* uri, uint16_t* index)
{
    return c::change(server, [&]() -> StatusCode {
        if (uri == nullptr || *uri == '\0' || index == nullptr) {
            return status::Bad_InvalidArgument;
        }
        const auto added = server->server->address_space().add_namespace(uri);
        *index = added.value_or(0);
        return added ? status::Good : added.error();
    });
}

busbar_status busbar_server_add_object(busbar_server* server, const busbar_node* node,
                                       const char* type)
{
    return c::change(server, [&]() -> StatusCode {
        if (node == nullptr) {
            return status::Bad_InvalidArgument;
        }
        model::AddressSpace& space = server->server->address_space();
        const auto made = c::new_node_of(space, *node, id::ObjectsFolder);
        if (!made) {
            return made.error();
        }
        model::NewObject object;
        object.type_definition = NodeId{0, id::FolderType};
        if (type != nullptr) {
            auto definition = NodeId::parse(type);
            if (!definition) {
                return status::Bad_TypeDefinitionInvalid;
            }
            object.type_definition = *std::move(definition);
        }
        const auto added = space.add_object(*made, object);
        return added ? status::Good : added.error();
    });
}

busbar_status busbar_server_add_object_type(busbar_server* server, const busbar_node* node,
                                            const busbar_property* properties,
                                            size_t property_count)
{
    return c::change(server, [&]() -> StatusCode {
        if (node == nullptr || !c::has_all(properties, property_count)) {
            return status::Bad_InvalidArgument;
        }
        model::AddressSpace& space = server->server->address_space();
        const auto made = c::new_node_of(space, *node, id::BaseObjectType);
        if (!made) {
            return made.error();
        }
        // Types cannot be removed: what would fail is found before.
        if (const StatusCode checked = c::check_properties({properties, property_count});
            checked.is_bad()) {
            return checked;
        }
        const auto added = space.add_object_type(*made);
        return added ? c::add_properties(space, *added, node->namespace_index,
                                         {properties, property_count})
                     : added.error();
    });
}

busbar_status busbar_server_add_reference(busbar_server* server, const char* source,
                                          const char* type, const char* target)
{
    return c::change(server, [&]() -> StatusCode {
        model::AddressSpace& space = server->server->address_space();
        const auto type_id = c::node_id_of(type);
        const model::NodeIndex from = c::find_node(space, source);
        const model::NodeIndex to = c::find_node(space, target);
        if (!type_id || from == model::no_node || to == model::no_node) {
            return type_id ? status::Bad_NodeIdUnknown : status::Bad_ReferenceTypeIdInvalid;
        }
        const auto added = space.add_reference(from, *type_id, to);
        return added ? status::Good : added.error();
    });
}

busbar_status busbar_server_remove_node(busbar_server* server, const char* id)
{
    return c::change(server, [&]() -> StatusCode {
        model::AddressSpace& space = server->server->address_space();
        const model::NodeIndex node = c::find_node(space, id);
        if (node == model::no_node) {
            return status::Bad_NodeIdUnknown;
        }
        c::ServedNodes served{*server, node};
        const auto removed = space.remove(node);
        if (!removed) {
            return removed.error();
        }
        served.free();
        return status::Good;
    });
}
