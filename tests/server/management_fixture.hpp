#pragma once

#include <initializer_list>
#include <string>

#include <catch2/catch.hpp>

#include <busbar/types/ids.hpp>
#include <busbar/types/node_management.hpp>

#include "support/server_fixture.hpp"

namespace busbar::test {

/// Lets everybody do all but what a test takes away.
class Rights final : public server::AccessControl {
public:
    [[nodiscard]] bool may_browse(const server::UserIdentity&, const NodeId& node) const override
    {
        return node != hidden;
    }
    [[nodiscard]] std::uint8_t user_access_level(const server::UserIdentity&, const NodeId&,
                                                 std::uint8_t level) const override
    {
        return level;
    }
    [[nodiscard]] bool may_add_node(const server::UserIdentity&, const NodeId& node) const override
    {
        return node != kept;
    }
    [[nodiscard]] bool may_delete_node(const server::UserIdentity&,
                                       const NodeId& node) const override
    {
        return node != kept;
    }
    [[nodiscard]] bool may_add_reference(const server::UserIdentity&,
                                         const NodeId& node) const override
    {
        return node != kept;
    }
    [[nodiscard]] bool may_remove_reference(const server::UserIdentity&,
                                            const NodeId& node) const override
    {
        return node != kept;
    }

    NodeId hidden{1, "hidden"};
    NodeId kept{1, "kept"};
};

struct NoWaker final : server::Waker {
    void wake() override {}
};

struct Outside {
    Rights rights;
    NoWaker no_waker;
};

inline server::ServerConfig config_with(bool has_node_management, std::size_t max_nodes)
{
    server::ServerConfig config = ServerFixture::insecure_config();
    config.has_node_management = has_node_management;
    config.limits.operations.max_nodes_per_node_management = 20;
    config.limits.max_client_nodes = max_nodes;
    config.limits.max_client_references = 3;
    return config;
}

struct ManagementFixture : Outside, ServerFixture {
    explicit ManagementFixture(bool has_node_management = true, std::size_t max_nodes = 100)
        : ServerFixture{no_waker, config_with(has_node_management, max_nodes), &rights},
          client{log_in_manager()}
    {
        for (const char* name : {"folder", "kept", "hidden"}) {
            REQUIRE(server.address_space().add_folder(named(name)));
        }
    }
    /// Whom the RolePermissions of namespace 0 let change it.
    [[nodiscard]] TestClient log_in_manager()
    {
        users.everybody.roles = {"ConfigureAdmin"};
        return log_in();
    }
    [[nodiscard]] model::NewNode named(const char* name, const NodeId& parent = objects)
    {
        model::NewNode node;
        node.id = NodeId{1, name};
        node.browse_name = QualifiedName{1, name};
        node.parent = server.address_space().find(parent);
        return node;
    }
    /// A folder "new" below "folder".
    [[nodiscard]] static AddNodesItem item(const char* name = "new")
    {
        AddNodesItem item;
        item.parent_node_id = folder;
        item.reference_type_id = NodeId{0, id::Organizes};
        item.requested_new_node_id = NodeId{1, name};
        item.browse_name = QualifiedName{1, name};
        item.node_class = NodeClass::Object;
        item.type_definition = NodeId{0, id::FolderType};
        return item;
    }
    [[nodiscard]] static AddNodesItem variable_item(VariableAttributes attributes = {})
    {
        AddNodesItem made = item();
        made.node_class = NodeClass::Variable;
        made.type_definition = NodeId{0, id::BaseDataVariableType};
        made.node_attributes = ExtensionObject::from(std::move(attributes));
        return made;
    }
    [[nodiscard]] static AddNodesItem generic_item(GenericAttributes attributes)
    {
        AddNodesItem made = variable_item();
        made.node_attributes = ExtensionObject::from(std::move(attributes));
        return made;
    }
    [[nodiscard]] AddNodesResult add(AddNodesItem item)
    {
        AddNodesRequest request;
        request.nodes_to_add = {std::move(item)};
        const auto response = client.call<AddNodesResponse>(std::move(request));
        REQUIRE(response);
        REQUIRE(response->results.size() == 1);
        CHECK(response->results[0].added_node_id.is_null() ==
              response->results[0].status_code.is_bad());
        return response->results[0];
    }
    [[nodiscard]] StatusCode status_of_adding(AddNodesItem item)
    {
        return add(std::move(item)).status_code;
    }
    [[nodiscard]] StatusCode remove(const NodeId& node)
    {
        DeleteNodesRequest request;
        request.nodes_to_delete = {{node, true}};
        const auto response = client.call<DeleteNodesResponse>(std::move(request));
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] static AddReferencesItem reference(const NodeId& source, std::uint32_t type,
                                                     const NodeId& target,
                                                     NodeClass node_class = NodeClass::Object)
    {
        return {source, NodeId{0, type}, true, {}, target, node_class};
    }
    [[nodiscard]] StatusCode add(AddReferencesItem item)
    {
        AddReferencesRequest request;
        request.references_to_add = {std::move(item)};
        const auto response = client.call<AddReferencesResponse>(std::move(request));
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] StatusCode remove(DeleteReferencesItem item)
    {
        DeleteReferencesRequest request;
        request.references_to_delete = {std::move(item)};
        const auto response = client.call<DeleteReferencesResponse>(std::move(request));
        REQUIRE(response);
        return response->results[0];
    }
    [[nodiscard]] Variant attribute(const NodeId& node, AttributeId attribute)
    {
        auto& space = server.address_space();
        const auto value = space.attribute(space.find(node), attribute);
        return value ? *value : Variant{};
    }

    static inline const NodeId objects{0, id::ObjectsFolder};
    static inline const NodeId folder{1, "folder"};
    TestClient client;
};

struct NoManagement : ManagementFixture {
    NoManagement() : ManagementFixture{false} {}
};

struct SmallManagement : ManagementFixture {
    SmallManagement() : ManagementFixture{true, 2} {}
};

constexpr std::uint32_t mask(std::initializer_list<NodeAttributesMask> bits)
{
    std::uint32_t all = 0;
    for (const NodeAttributesMask bit : bits) {
        all |= static_cast<std::uint32_t>(bit);
    }
    return all;
}

} // namespace busbar::test
