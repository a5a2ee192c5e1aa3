#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/types/attribute.hpp>
#include <busbar/types/node_management.hpp>
#include <busbar/types/view.hpp>

#include "event_fixture.hpp"
#include "subscription_fixture.hpp"

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;

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

server::ServerConfig config_with(bool has_node_management, std::size_t max_nodes)
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
          client{log_in()}
    {
        for (const char* name : {"folder", "kept", "hidden"}) {
            REQUIRE(server.address_space().add_folder(named(name)));
        }
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

} // namespace

TEST_CASE_METHOD(NoManagement, "Node management is off unless it is switched on")
{
    AddNodesRequest request;
    request.nodes_to_add = {item()};
    CHECK(client.status_of<AddNodesResponse>(request) == status::Bad_ServiceUnsupported);
    CHECK(client.status_of<AddReferencesResponse>(AddReferencesRequest{}) ==
          status::Bad_ServiceUnsupported);
    CHECK(client.status_of<DeleteNodesResponse>(DeleteNodesRequest{}) ==
          status::Bad_ServiceUnsupported);
    CHECK(client.status_of<DeleteReferencesResponse>(DeleteReferencesRequest{}) ==
          status::Bad_ServiceUnsupported);
}

TEST_CASE_METHOD(ManagementFixture,
                 "Node management requests have something to do, but not too much")
{
    AddNodesRequest request;
    CHECK(client.status_of<AddNodesResponse>(request) == status::Bad_NothingToDo);
    request.nodes_to_add.resize(21);
    CHECK(client.status_of<AddNodesResponse>(request) == status::Bad_TooManyOperations);
    CHECK(client.status_of<DeleteReferencesResponse>(DeleteReferencesRequest{}) ==
          status::Bad_NothingToDo);
}

TEST_CASE("Without an AccessControl only ConfigureAdmin manages nodes")
{
    server::UserIdentity user;
    CHECK_FALSE(server::is_configure_admin(user));
    user.roles = {"Operator", "ConfigureAdmin"};
    CHECK(server::is_configure_admin(user));

    ServerFixture fixture{config_with(true, 10)};
    AddNodesRequest request;
    request.nodes_to_add = {ManagementFixture::item()};
    request.nodes_to_add[0].parent_node_id = ManagementFixture::objects;
    TestClient reader = fixture.log_in();
    CHECK(reader.call<AddNodesResponse>(request)->results[0].status_code ==
          status::Bad_UserAccessDenied);
    fixture.users.everybody = user;
    TestClient admin = fixture.log_in();
    CHECK(admin.call<AddNodesResponse>(request)->results[0].status_code == status::Good);
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes adds nodes with the attributes that are specified")
{
    VariableAttributes attributes;
    attributes.specified_attributes = mask(
        {NodeAttributesMask::DisplayName, NodeAttributesMask::Value, NodeAttributesMask::DataType,
         NodeAttributesMask::ValueRank, NodeAttributesMask::AccessLevel});
    attributes.display_name = LocalizedText{"en", "New"};
    attributes.description = LocalizedText{"en", "not specified"};
    attributes.value = std::int32_t{7};
    attributes.data_type = NodeId{0, id::Int32};
    attributes.value_rank = -1;
    attributes.access_level = 3;
    attributes.historizing = true; // not specified
    const AddNodesResult result = add(variable_item(attributes));
    REQUIRE(result.status_code == status::Good);
    const NodeId added = result.added_node_id;
    CHECK(added == NodeId{1, "new"});
    CHECK(attribute(added, AttributeId::DisplayName) == Variant{attributes.display_name});
    CHECK(attribute(added, AttributeId::Description) == Variant{});
    CHECK(attribute(added, AttributeId::AccessLevel) == Variant{std::uint8_t{3}});
    CHECK(attribute(added, AttributeId::Historizing) == Variant{false});
    CHECK(server.address_space().value(server.address_space().find(added)) ==
          Variant{std::int32_t{7}});
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes takes GenericAttributes and defaults of the type")
{
    GenericAttributes attributes;
    attributes.attribute_values = {
        {static_cast<std::uint32_t>(AttributeId::DataType), NodeId{0, id::Double}},
        {static_cast<std::uint32_t>(AttributeId::ValueRank), std::int32_t{1}},
        {static_cast<std::uint32_t>(AttributeId::ArrayDimensions), Array<std::uint32_t>{3}}};
    AddNodesItem made = generic_item(attributes);
    made.requested_new_node_id = {};
    const AddNodesResult result = add(made);
    REQUIRE(result.status_code == status::Good);
    // The server's own namespace, whatever the BrowseName's is.
    CHECK(result.added_node_id.namespace_index() == 1);
    CHECK(attribute(result.added_node_id, AttributeId::DataType) == Variant{NodeId{0, id::Double}});
    CHECK(attribute(result.added_node_id, AttributeId::ArrayDimensions) ==
          Variant{Array<std::uint32_t>{3}});
    made = variable_item();
    made.node_attributes = {};
    REQUIRE(status_of_adding(made) == status::Bad_BrowseNameDuplicated);
    made.browse_name = QualifiedName{1, "plain"};
    REQUIRE(status_of_adding(made) == status::Good);
    CHECK(attribute(NodeId{1, "new"}, AttributeId::DataType) ==
          Variant{NodeId{0, id::BaseDataType}});
    CHECK(attribute(NodeId{1, "new"}, AttributeId::ValueRank) == Variant{std::int32_t{-2}});
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes adds nodes of every NodeClass")
{
    struct Case {
        NodeClass node_class;
        std::uint32_t parent;
        std::uint32_t reference;
        ExtensionObject attributes;
    };
    const Case cases[] = {
        {NodeClass::Method, id::ObjectsFolder, id::HasComponent,
         ExtensionObject::from(MethodAttributes{})},
        {NodeClass::ObjectType, id::BaseObjectType, id::HasSubtype,
         ExtensionObject::from(ObjectTypeAttributes{})},
        {NodeClass::VariableType, id::BaseDataVariableType, id::HasSubtype,
         ExtensionObject::from(VariableTypeAttributes{})},
        {NodeClass::ReferenceType, id::Organizes, id::HasSubtype,
         ExtensionObject::from(ReferenceTypeAttributes{})},
        {NodeClass::DataType, id::Structure, id::HasSubtype,
         ExtensionObject::from(DataTypeAttributes{})},
        {NodeClass::View, id::ViewsFolder, id::Organizes, ExtensionObject::from(ViewAttributes{})},
    };
    for (const Case& each : cases) {
        AddNodesItem made = item(std::to_string(static_cast<int>(each.node_class)).c_str());
        made.parent_node_id = NodeId{0, each.parent};
        made.reference_type_id = NodeId{0, each.reference};
        made.node_class = each.node_class;
        made.type_definition = {};
        made.node_attributes = each.attributes;
        const AddNodesResult result = add(made);
        CHECK(result.status_code == status::Good);
        CHECK(attribute(result.added_node_id, AttributeId::NodeClass) == Variant{each.node_class});
    }
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes says what is wrong with place and name of a node")
{
    AddNodesItem made = item();
    SECTION("parents")
    {
        for (const ExpandedNodeId& parent :
             {ExpandedNodeId{}, ExpandedNodeId{NodeId{1, "none"}}, ExpandedNodeId{rights.hidden},
              ExpandedNodeId{folder, {}, 1}, ExpandedNodeId{folder, "urn:x"}}) {
            made.parent_node_id = parent;
            CHECK(status_of_adding(made) == status::Bad_ParentNodeIdInvalid);
        }
        made.parent_node_id = rights.kept;
        CHECK(status_of_adding(made) == status::Bad_UserAccessDenied);
    }
    SECTION("references")
    {
        for (const NodeId& type :
             {NodeId{}, NodeId{1, "none"}, folder, NodeId{0, id::HierarchicalReferences}}) {
            made.reference_type_id = type;
            CHECK(status_of_adding(made) == status::Bad_ReferenceTypeIdInvalid);
        }
        for (const std::uint32_t type : {id::HasSubtype, id::HasProperty, id::GeneratesEvent}) {
            made.reference_type_id = NodeId{0, type};
            CHECK(status_of_adding(made) == status::Bad_ReferenceNotAllowed);
        }
    }
    SECTION("NodeIds")
    {
        for (const ExpandedNodeId& id :
             {ExpandedNodeId{NodeId{0, 99'999U}}, ExpandedNodeId{NodeId{9, 1U}},
              ExpandedNodeId{NodeId{1, ""}}, ExpandedNodeId{NodeId{1, "new"}, {}, 1},
              ExpandedNodeId{NodeId{1, "new"}, "urn:x"}}) {
            made.requested_new_node_id = id;
            CHECK(status_of_adding(made) == status::Bad_NodeIdRejected);
        }
        made.requested_new_node_id = folder;
        CHECK(status_of_adding(made) == status::Bad_NodeIdExists);
    }
    SECTION("BrowseNames")
    {
        for (const QualifiedName& name :
             {QualifiedName{}, QualifiedName{1, ""}, QualifiedName{9, "x"},
              QualifiedName{1, String{std::string(513, 'x')}}}) {
            made.browse_name = name;
            CHECK(status_of_adding(made) == status::Bad_BrowseNameInvalid);
        }
        CHECK(status_of_adding(item()) == status::Good);
        made = item("other");
        made.browse_name = QualifiedName{1, "new"};
        CHECK(status_of_adding(made) == status::Bad_BrowseNameDuplicated);
    }
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes says what is wrong with class, type and attributes")
{
    AddNodesItem made = item();
    for (const int node_class : {0, 3, 256, -1}) {
        made.node_class = NodeClass{node_class};
        CHECK(status_of_adding(made) == status::Bad_NodeClassInvalid);
    }
    made = item();
    // The last one has mandatory members that would have to come with it.
    for (const ExpandedNodeId& type :
         {ExpandedNodeId{}, ExpandedNodeId{NodeId{1, "none"}}, ExpandedNodeId{folder},
          ExpandedNodeId{NodeId{0, id::BaseDataVariableType}},
          ExpandedNodeId{NodeId{0, id::BaseEventType}}, ExpandedNodeId{NodeId{0, id::FileType}}}) {
        made.type_definition = type;
        CHECK(status_of_adding(made) == status::Bad_TypeDefinitionInvalid);
    }
    made = item();
    made.node_class = NodeClass::View;
    CHECK(status_of_adding(made) == status::Bad_TypeDefinitionInvalid);

    made = item();
    made.node_attributes = ExtensionObject::from(VariableAttributes{});
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
    made.node_attributes = ExtensionObject::from_binary(NodeId{0, 1U}, ByteString{});
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
    ObjectAttributes object;
    object.specified_attributes = mask({NodeAttributesMask::EventNotifier});
    object.event_notifier = 4; // HistoryRead
    made.node_attributes = ExtensionObject::from(object);
    CHECK(status_of_adding(made) == status::Bad_NodeAttributesInvalid);
}

TEST_CASE_METHOD(ManagementFixture, "AddNodes checks the attributes of Variables")
{
    const auto refused = [&](NodeAttributesMask bit, auto change) {
        VariableAttributes attributes;
        attributes.specified_attributes =
            mask({bit, NodeAttributesMask::DataType, NodeAttributesMask::ValueRank});
        attributes.data_type = NodeId{0, id::Int32};
        attributes.value_rank = -1;
        change(attributes);
        return status_of_adding(variable_item(attributes)) == status::Bad_NodeAttributesInvalid;
    };
    using Mask = NodeAttributesMask;
    CHECK(refused(Mask::Value, [](auto& a) { a.value = "text"; }));
    CHECK(refused(Mask::DataType, [](auto& a) { a.data_type = folder; }));
    CHECK(refused(Mask::ValueRank, [](auto& a) { a.value_rank = -4; }));
    CHECK(refused(Mask::ArrayDimensions, [](auto& a) { a.array_dimensions = {1, 2}; }));
    CHECK(refused(Mask::Historizing, [](auto& a) { a.historizing = true; }));
    CHECK(refused(Mask::WriteMask, [](auto& a) { a.write_mask = 1; }));
    CHECK(refused(Mask::AccessLevel, [](auto& a) { a.access_level = 8; }));

    const auto refuses = [&](Array<GenericAttributeValue> values) {
        GenericAttributes attributes;
        attributes.attribute_values = std::move(values);
        return status_of_adding(generic_item(attributes)) == status::Bad_NodeAttributesInvalid;
    };
    const auto rank = static_cast<std::uint32_t>(AttributeId::ValueRank);
    CHECK(refuses({{rank, std::int32_t{-1}}, {rank, std::int32_t{-1}}}));
    CHECK(refuses({{rank, std::uint32_t{1}}}));
    CHECK(refuses({{static_cast<std::uint32_t>(AttributeId::DisplayName), LocalizedText{"x"}}}));
    CHECK(refuses({{static_cast<std::uint32_t>(AttributeId::IsAbstract), true}}));
    CHECK(refuses({{static_cast<std::uint32_t>(AttributeId::RolePermissions), Variant{}}}));
    CHECK(refuses({{32, true}}));
    CHECK(refuses({{0xFFFF'FFFF, true}}));
}

TEST_CASE_METHOD(SmallManagement, "Clients add so many nodes and references and no more")
{
    REQUIRE(status_of_adding(item("a")) == status::Good);
    REQUIRE(status_of_adding(item("b")) == status::Good);
    CHECK(status_of_adding(item("c")) == status::Bad_OutOfMemory);
    REQUIRE(remove(NodeId{1, "a"}) == status::Good);
    REQUIRE(status_of_adding(item("c")) == status::Good);
    CHECK(status_of_adding(item("d")) == status::Bad_OutOfMemory);
    // Nor does it matter who removes them.
    auto& space = server.address_space();
    REQUIRE(space.remove(space.find(NodeId{1, "b"})));
    CHECK(status_of_adding(item("d")) == status::Good);

    const auto add_to = [&](const char* name) {
        return add(reference(NodeId{0, id::Server}, id::Organizes, NodeId{1, name}));
    };
    REQUIRE(add_to("folder") == status::Good);
    REQUIRE(add_to("c") == status::Good);
    REQUIRE(add_to("d") == status::Good);
    CHECK(add_to("kept") == status::Bad_UserAccessDenied);
    CHECK(add(reference(folder, id::Organizes, objects)) == status::Bad_OutOfMemory);
    REQUIRE(remove(NodeId{1, "c"}) == status::Good);
    CHECK(add(reference(folder, id::Organizes, objects)) == status::Good);
}

TEST_CASE_METHOD(ManagementFixture, "A large node counts for its size")
{
    VariableAttributes attributes;
    attributes.specified_attributes = mask({NodeAttributesMask::Value});
    attributes.value = ByteString{std::vector<std::byte>(3U << 20U)};
    CHECK(status_of_adding(variable_item(attributes)) == status::Bad_OutOfMemory);
}

TEST_CASE_METHOD(ManagementFixture, "AddReferences adds references in both directions")
{
    REQUIRE(status_of_adding(item()) == status::Good);
    const NodeId added{1, "new"};
    REQUIRE(add(reference(objects, id::Organizes, added)) == status::Good);
    CHECK(add(reference(objects, id::Organizes, added)) ==
          status::Bad_DuplicateReferenceNotAllowed);
    AddReferencesItem inverse = reference(added, id::Organizes, objects);
    inverse.is_forward = false;
    CHECK(add(inverse) == status::Bad_DuplicateReferenceNotAllowed);
    CHECK(remove(DeleteReferencesItem{added, NodeId{0, id::Organizes}, false, objects, true}) ==
          status::Good);
    inverse.target_server_uri = server.config().application_uri;
    CHECK(add(inverse) == status::Good);
}

TEST_CASE_METHOD(ManagementFixture, "AddReferences says what is wrong with a reference")
{
    const AddReferencesItem good = reference(objects, id::Organizes, NodeId{1, "kept"});
    AddReferencesItem bad = good;
    for (const NodeId& source : {NodeId{}, NodeId{1, "none"}, rights.hidden}) {
        bad.source_node_id = source;
        CHECK(add(bad) == status::Bad_SourceNodeIdInvalid);
    }
    bad = good;
    for (const NodeId& type : {NodeId{}, folder, NodeId{0, id::HierarchicalReferences}}) {
        bad.reference_type_id = type;
        CHECK(add(bad) == status::Bad_ReferenceTypeIdInvalid);
    }
    bad = good;
    bad.target_server_uri = "no uri";
    CHECK(add(bad) == status::Bad_ServerUriInvalid);
    bad.target_server_uri = "urn:another:server";
    CHECK(add(bad) == status::Bad_ReferenceLocalOnly);
    bad = good;
    bad.target_node_id.server_index = 1;
    CHECK(add(bad) == status::Bad_ReferenceLocalOnly);
    bad.target_node_id = NodeId{1, "none"};
    CHECK(add(bad) == status::Bad_TargetNodeIdInvalid);
    bad = good;
    bad.target_node_class = NodeClass::Variable;
    CHECK(add(bad) == status::Bad_NodeClassInvalid);
    CHECK(add(good) == status::Bad_UserAccessDenied);
    CHECK(add(reference(folder, id::Organizes, folder)) == status::Bad_InvalidSelfReference);
    CHECK(add(reference(objects, id::HasSubtype, folder)) == status::Bad_ReferenceNotAllowed);
    CHECK(add(reference(objects, id::HasProperty, folder)) == status::Bad_ReferenceNotAllowed);
}

TEST_CASE_METHOD(ManagementFixture, "Components do not go round")
{
    AddNodesItem part = item("part");
    part.reference_type_id = NodeId{0, id::HasComponent};
    REQUIRE(status_of_adding(part) == status::Good);
    const NodeId added{1, "part"};
    CHECK(add(reference(added, id::HasComponent, folder)) == status::Bad_ReferenceNotAllowed);
    CHECK(add(reference(added, id::Organizes, folder)) == status::Good);
}

TEST_CASE_METHOD(ManagementFixture, "DeleteReferences says what cannot be deleted")
{
    const DeleteReferencesItem good{objects, NodeId{0, id::Organizes}, true, folder, true};
    // It came with the node.
    DeleteReferencesItem own = good;
    CHECK(remove(own) == status::Bad_NoDeleteRights);
    CHECK(remove({objects, NodeId{0, id::Organizes}, true, NodeId{0, id::Server}, true}) ==
          status::Bad_NoDeleteRights);
    CHECK(remove({folder, NodeId{0, id::Organizes}, true, objects, true}) == status::Bad_NotFound);
    DeleteReferencesItem bad = good;
    bad.source_node_id = NodeId{1, "none"};
    CHECK(remove(bad) == status::Bad_SourceNodeIdInvalid);
    bad = good;
    bad.reference_type_id = folder;
    CHECK(remove(bad) == status::Bad_ReferenceTypeIdInvalid);
    bad = good;
    bad.target_node_id = NodeId{1, "none"};
    CHECK(remove(bad) == status::Bad_TargetNodeIdInvalid);
    bad.target_node_id.server_index = 1;
    CHECK(remove(bad) == status::Bad_ServerIndexInvalid);
    bad = good;
    bad.target_node_id = rights.kept;
    CHECK(remove(bad) == status::Bad_UserAccessDenied);
}

TEST_CASE_METHOD(ManagementFixture, "DeleteNodes deletes a node with what is below it")
{
    auto& space = server.address_space();
    REQUIRE(status_of_adding(item()) == status::Good);
    REQUIRE(remove(folder) == status::Good);
    CHECK(space.find(folder) == model::no_node);
    CHECK(space.find(NodeId{1, "new"}) == model::no_node);

    CHECK(remove(NodeId{}) == status::Bad_NodeIdInvalid);
    CHECK(remove(folder) == status::Bad_NodeIdUnknown);
    CHECK(remove(rights.hidden) == status::Bad_NodeIdUnknown);
    CHECK(remove(objects) == status::Bad_UserAccessDenied); // "kept" is below it
    CHECK(remove(NodeId{0, id::TypesFolder}) == status::Bad_NoDeleteRights);
    REQUIRE(space.add_folder(named("above")));
    REQUIRE(space.remove(space.find(rights.kept)));
    REQUIRE(space.add_folder(named("kept", NodeId{1, "above"})));
    CHECK(remove(NodeId{1, "above"}) == status::Bad_UserAccessDenied);
    CHECK(space.find(NodeId{1, "above"}) != model::no_node);
}
