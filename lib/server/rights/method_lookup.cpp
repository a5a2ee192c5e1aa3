#include "method_lookup.hpp"

#include <algorithm>

#include <busbar/types/ids.hpp>

#include "built_in_methods.hpp"

namespace busbar::server::detail {

namespace {

using model::AddressSpace;
using model::NodeIndex;

/// The node that has a Method as its component, relative to the called object.
enum class Owner { Nobody, Type, Itself };

/// A Method of a type may be a component of every Object of it: it is searched from the Object and
/// its types, which have it under its name.
Owner find_owner(const AddressSpace& space, NodeIndex object, NodeIndex type, NodeIndex method,
                 std::size_t& visits)
{
    const NodeIndex has_component = space.find(id::HasComponent);
    const auto has_method = [&](NodeIndex node) {
        bool is_found = false;
        const std::size_t visited = space.for_each_child(
            node, has_component, true, space.browse_name(method), [&](NodeIndex child) {
                is_found = child == method;
                return !is_found;
            });
        visits -= std::min(visits, visited + 1);
        return is_found;
    };
    if (has_method(object)) {
        return Owner::Itself;
    }
    while (type != model::no_node && visits != 0) {
        if (has_method(type)) {
            return Owner::Type;
        }
        type = space.supertype(type);
    }
    return Owner::Nobody;
}

/// Returns the Object's Method that overrides one of its type; the latter if there is none.
NodeIndex find_override(const AddressSpace& space, NodeIndex object, NodeIndex method,
                        std::size_t& visits)
{
    NodeIndex found = method;
    const std::size_t visited =
        space.for_each_child(object, space.find(id::HasComponent), true, space.browse_name(method),
                             [&](NodeIndex child) {
                                 const bool is_method =
                                     space.node_class(child) == NodeClass::Method;
                                 found = is_method ? child : found;
                                 return !is_method;
                             });
    visits -= std::min(visits, visited + 1);
    return found;
}

} // namespace

Result<NodeIndex> find_method(const AddressSpace& space, const NodeRights& rights,
                              const NodeId& object_id, const NodeId& method_id, std::size_t& visits)
{
    if (visits == 0) {
        return fail(status::Bad_TooManyOperations);
    }
    const NodeIndex object = space.find(object_id);
    if (object == model::no_node || !rights.may_see(object)) {
        return fail(why_not_found(object_id));
    }
    const NodeClass object_class = space.node_class(object);
    if (object_class != NodeClass::Object && object_class != NodeClass::ObjectType) {
        return fail(status::Bad_NodeIdInvalid);
    }
    const NodeIndex method = space.find(method_id);
    if (method == model::no_node || !rights.may_see(method)) {
        return fail(why_not_found(method_id));
    }
    if (space.node_class(method) != NodeClass::Method) {
        return fail(status::Bad_MethodInvalid);
    }
    const NodeIndex type =
        object_class == NodeClass::Object ? space.type_definition(object) : object;
    switch (find_owner(space, object, type, method, visits)) {
    case Owner::Itself:
        return method;
    case Owner::Type:
        return find_override(space, object, method, visits);
    case Owner::Nobody:
        break;
    }
    return fail(visits == 0 ? status::Bad_TooManyOperations : status::Bad_MethodInvalid);
}

bool is_executable(const AddressSpace& space, NodeIndex method)
{
    const model::MethodAttributes attributes = space.method(method);
    return attributes.executable &&
           (attributes.source != model::no_source || is_built_in_method(space.node_id(method)));
}

bool is_user_executable(const AddressSpace& space, const NodeRights& rights, NodeIndex method)
{
    const NodeId& id = space.node_id(method);
    if (rights.user.must_change_password && !is_change_password(id)) {
        return false;
    }
    const bool is_servers_own = is_built_in_method(id) || is_change_password(id);
    return is_executable(space, method) && rights.may_call(method, is_servers_own);
}

} // namespace busbar::server::detail
