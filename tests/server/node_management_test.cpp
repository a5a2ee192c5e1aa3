#include <catch2/catch.hpp>

#include "management_fixture.hpp"

namespace node_management_test {

using namespace busbar;
using namespace busbar::test;

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

TEST_CASE_METHOD(ManagementFixture, "References make place again when a node at one end is removed")
{
    for (const char* name : {"a", "b", "c"}) {
        REQUIRE(status_of_adding(item(name)) == status::Good);
    }
    const auto connect = [&](const char* from, const char* to) {
        return add(reference(NodeId{1, from}, id::Organizes, NodeId{1, to}));
    };
    REQUIRE(connect("a", "b") == status::Good);
    REQUIRE(connect("b", "a") == status::Good);
    REQUIRE(connect("b", "c") == status::Good);
    CHECK(connect("c", "b") == status::Bad_OutOfMemory);
    auto& space = server.address_space();
    REQUIRE(space.remove(space.find(NodeId{1, "a"})));
    REQUIRE(status_of_adding(item("a")) == status::Good);
    REQUIRE(connect("c", "b") == status::Good);
    REQUIRE(connect("a", "b") == status::Good);
    CHECK(connect("b", "a") == status::Bad_OutOfMemory);
}

TEST_CASE_METHOD(ManagementFixture, "AddReferences adds references in both directions",
                 "[unit:Node Management Add Ref]")
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

TEST_CASE_METHOD(ManagementFixture, "DeleteReferences says what cannot be deleted",
                 "[unit:Node Management Delete Ref]")
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

TEST_CASE_METHOD(ManagementFixture, "DeleteNodes deletes a node with what is below it",
                 "[unit:Node Management Delete Node]")
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

TEST_CASE_METHOD(ManagementFixture, "No reference is left with one end")
{
    auto& space = server.address_space();
    const auto references_of = [&](const NodeId& node) {
        std::size_t count = 0;
        model::ReferenceCursor cursor = space.references(space.find(node));
        while (const auto reference = cursor.next()) {
            CHECK(space.exists(reference->target));
            ++count;
        }
        return count;
    };
    const NodeId other{1, "other"};
    REQUIRE(status_of_adding(item()) == status::Good);
    REQUIRE(status_of_adding(item("other")) == status::Good);
    const std::size_t before = references_of(other);
    SECTION("deleteBidirectional is not set")
    {
        REQUIRE(add(reference(NodeId{1, "new"}, id::Organizes, other)) == status::Good);
        CHECK(remove(DeleteReferencesItem{NodeId{1, "new"}, NodeId{0, id::Organizes}, true, other,
                                          false}) == status::Good);
    }
    SECTION("deleteTargetReferences is not set")
    {
        REQUIRE(add(reference(NodeId{1, "new"}, id::Organizes, other)) == status::Good);
        REQUIRE(add(reference(other, id::Organizes, NodeId{1, "new"})) == status::Good);
        DeleteNodesRequest request;
        request.nodes_to_delete = {{NodeId{1, "new"}, false}};
        const auto response = client.call<DeleteNodesResponse>(request);
        REQUIRE(response);
        CHECK(response->results[0] == status::Good);
        CHECK(space.find(NodeId{1, "new"}) == model::no_node);
    }
    CHECK(references_of(other) == before);
}

TEST_CASE_METHOD(ManagementFixture, "Types are not deleted, nor what a node is an instance of")
{
    auto& space = server.address_space();
    REQUIRE(space.add_object_type(named("Type", NodeId{0, id::BaseObjectType})));
    AddNodesItem made = item();
    made.type_definition = NodeId{1, "Type"};
    REQUIRE(status_of_adding(made) == status::Good);
    CHECK(remove(NodeId{1, "Type"}) == status::Bad_NoDeleteRights);
    for (const bool is_forward : {true, false}) {
        const NodeId source{1, is_forward ? "new" : "Type"};
        const NodeId target{1, is_forward ? "Type" : "new"};
        CHECK(remove(DeleteReferencesItem{source, NodeId{0, id::HasTypeDefinition}, is_forward,
                                          target, true}) == status::Bad_NoDeleteRights);
    }
}

} // namespace node_management_test
