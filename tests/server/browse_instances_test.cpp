#include <algorithm>

#include <catch2/catch.hpp>

#include "view_fixture.hpp"

namespace busbar::server::detail::browse_instances_test {

TEST_CASE_METHOD(ViewFixture, "A type lists its instances")
{
    model::NewNode type_node;
    type_node.id = node("Type");
    type_node.browse_name = {ns, "Type"};
    type_node.parent = space.find(id::BaseObjectType);
    REQUIRE(space.add_object_type(type_node));
    for (const char* name : {"a", "b", "c"}) {
        model::NewNode instance;
        instance.id = node(name);
        instance.browse_name = {ns, name};
        instance.parent = folder;
        REQUIRE(space.add_object(instance, {node("Type"), 0}));
    }
    BrowseDescription what = description(node("Type"));
    what.browse_direction = BrowseDirection::Inverse;
    what.reference_type_id = {};
    CHECK(names(browse_one(what)) == Names{"BaseObjectType", "a", "b", "c"});
    CHECK_FALSE(browse_one(what).references[1].is_forward);
    CHECK(browse_one(what).references[1].reference_type_id == NodeId{0, id::HasTypeDefinition});
    // By and by.
    BrowseResult part = browse_one(what, 2);
    CHECK(names(part) == Names{"BaseObjectType", "a"});
    REQUIRE(space.remove(space.find(node("b"))));
    part = next(part.continuation_point);
    CHECK(names(part) == Names{"c"});
    CHECK(part.continuation_point.is_null());

    what.reference_type_id = NodeId{0, id::HasTypeDefinition};
    CHECK(names(browse_one(what)) == Names{"a", "c"});
    what.reference_type_id = NodeId{0, id::NonHierarchicalReferences};
    CHECK(names(browse_one(what)) == Names{"a", "c"});
    what.include_subtypes = false;
    CHECK(names(browse_one(what)).empty());
    what.reference_type_id = {};
    what.browse_direction = BrowseDirection::Forward;
    CHECK(names(browse_one(what)).empty());
    // One of namespace 0, of its own nodes.
    what = description(NodeId{0, id::FolderType});
    what.browse_direction = BrowseDirection::Both;
    what.reference_type_id = NodeId{0, id::HasTypeDefinition};
    const Names folders = names(browse_one(what));
    CHECK(std::find(folders.begin(), folders.end(), "Objects") != folders.end());
    CHECK(std::find(folders.begin(), folders.end(), "folder") != folders.end());
}

TEST_CASE_METHOD(ViewFixture, "Looking for instances stays within the work of a request")
{
    add_children(50);
    BrowseDescription what = description(NodeId{0, id::BaseDataVariableType});
    what.browse_direction = BrowseDirection::Inverse;
    what.reference_type_id = NodeId{0, id::HasTypeDefinition};
    const std::size_t all = browse_one(what).references.size();
    REQUIRE(all >= 50);
    BrowseRequest request;
    request.nodes_to_browse = {what};
    BrowseResponse response;
    ViewContext view = context();
    view.visits_left = space.node_count() / 2;
    REQUIRE(browse(view, request, response) == status::Good);
    BrowseResult result = response.results[0];
    std::size_t count = result.references.size();
    CHECK(count < all);
    REQUIRE_FALSE(result.continuation_point.is_null());
    while (!result.continuation_point.is_null()) {
        result = next(result.continuation_point);
        count += result.references.size();
    }
    CHECK(count == all);
}

} // namespace busbar::server::detail::browse_instances_test
