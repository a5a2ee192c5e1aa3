#include <array>

#include <busbar/server/modules.hpp>
#include <busbar/types/node_management.hpp>

#include "server/engine/run_service.hpp"
#include "server/engine/type_table.hpp"
#include "server/node_management/node_management_services.hpp"

namespace busbar::server {

namespace detail {

namespace {

struct NodeManagementServices final : ModulePart {
    explicit NodeManagementServices(Core& core)
        : needs{core.address_space,    core.config,       core.environment.access, client_nodes,
                core.model_observer(), core.rationed_log, core.own_namespace}
    {
    }

    ClientNodes client_nodes;
    const NodeManagementNeeds needs;
};

const NodeManagementNeeds& node_management_needs(Core& core)
{
    return static_cast<const NodeManagementServices&>(*core.node_management).needs;
}

constexpr std::array node_management_rows{
    operation<AddNodesRequest, make_add_nodes, node_management_needs>(Need::Activated),
    operation<AddReferencesRequest, make_add_references, node_management_needs>(Need::Activated),
    operation<DeleteNodesRequest, make_delete_nodes, node_management_needs>(Need::Activated),
    operation<DeleteReferencesRequest, make_delete_references, node_management_needs>(
        Need::Activated),
};

void add_node_management(Core& core)
{
    core.node_management = std::make_unique<NodeManagementServices>(core);
    core.services.add(node_management_rows);
    core.types.add(0, type_table<NodeAttributes, ObjectAttributes, VariableAttributes,
                                 MethodAttributes, ObjectTypeAttributes, VariableTypeAttributes,
                                 ReferenceTypeAttributes, DataTypeAttributes, ViewAttributes,
                                 GenericAttributes, StructureDefinition, EnumDefinition>());
}

} // namespace

} // namespace detail

constinit const Module modules::node_management{"node_management", detail::add_node_management};

} // namespace busbar::server
