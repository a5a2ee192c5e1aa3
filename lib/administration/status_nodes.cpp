#include "status_nodes.hpp"

#include <string>
#include <utility>

#include <busbar/types/ids.hpp>

namespace busbar::administration::detail {

namespace {

constexpr const char* status_name = "Status";

Result<void> add_fact(model::AddressSpace& space, NodeTable& table, model::NodeIndex object,
                      const StatusFact& fact)
{
    const std::uint16_t own = space.node_id(object).namespace_index();
    model::NewNode node;
    node.id = NodeId{own, String{std::string{status_name} + "/" + fact.name}};
    node.browse_name = QualifiedName{own, String{fact.name}};
    node.parent = object;
    model::NewVariable variable;
    variable.data_type = NodeId{0, static_cast<std::uint32_t>(fact.like.type())};
    variable.value_rank = fact.like.is_array() ? 1 : -1; // Part 3, 5.6.2
    if (fact.like.is_array()) {
        variable.array_dimensions = {0U};
    }
    const auto added = space.add_property(node, std::move(variable));
    if (!added) {
        return fail(added.error());
    }
    table.bind_value(space, *added, [value = fact.value] { return DataValue{value()}; });
    return {};
}

} // namespace

Configured<void> add_status_nodes(server::Server& server, NodeTable& table,
                                  std::span<const StatusFact> facts, Authorities authorities)
{
    model::AddressSpace& space = server.address_space();
    const std::uint16_t own =
        space.namespace_index(server.config().application_uri).value_or(std::uint16_t{1});
    model::NewNode node;
    node.id = NodeId{own, status_name};
    node.browse_name = QualifiedName{own, status_name};
    node.parent = space.find(id::ObjectsFolder);
    const auto object = space.add_object(node);
    Result<void> added = object ? Result<void>{} : fail(object.error());
    for (const StatusFact& fact : facts) {
        added = added ? add_fact(space, table, *object, fact) : added;
    }
    if (!added) {
        return misconfigured("status", "its nodes cannot be added", added.error());
    }
    give_rights(space, *object, Thing::ServiceStatus, authorities);
    return {};
}

} // namespace busbar::administration::detail
