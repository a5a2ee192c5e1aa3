#include <catch2/catch.hpp>

#include "view_fixture.hpp"

namespace busbar::server::detail::view_test {

TEST_CASE_METHOD(ViewFixture, "Browse tells of references what the ResultMask asks for",
                 "[unit:View Basic][unit:View Basic 2][unit:Address Space Base]")
{
    add_int32("v", folder);
    BrowseDescription what = description(node("folder"));
    const BrowseResult all = browse_one(what);
    CHECK(all.status_code == status::Good);
    CHECK(all.continuation_point.is_null());
    REQUIRE(all.references.size() == 1);
    const ReferenceDescription& reference = all.references[0];
    CHECK(reference.reference_type_id == NodeId{0, id::Organizes});
    CHECK(reference.is_forward);
    CHECK(reference.node_id.node_id == node("v"));
    CHECK(reference.browse_name == QualifiedName{ns, "v"});
    CHECK(reference.display_name == LocalizedText{"v"});
    CHECK(reference.node_class == NodeClass::Variable);
    CHECK(reference.type_definition.node_id == NodeId{0, id::BaseDataVariableType});

    what.result_mask = 0;
    ReferenceDescription bare;
    bare.node_id.node_id = node("v");
    CHECK(browse_one(what).references[0] == bare);
}

TEST_CASE_METHOD(ViewFixture, "Browse filters by direction, type and NodeClass")
{
    add_int32("v", folder);
    add_folder("f", folder);
    BrowseDescription what = description(node("folder"));
    CHECK(names(browse_one(what)) == Names{"v", "f"});
    what.node_class_mask = static_cast<std::uint32_t>(NodeClass::Variable);
    CHECK(names(browse_one(what)) == Names{"v"});
    what.node_class_mask = 0;
    what.include_subtypes = false;
    CHECK(browse_one(what).references.empty());
    what.reference_type_id = NodeId{0, id::Organizes};
    CHECK(names(browse_one(what)) == Names{"v", "f"});
    what.browse_direction = BrowseDirection::Inverse;
    CHECK(names(browse_one(what)) == Names{"Objects"});
    what.browse_direction = BrowseDirection::Both;
    CHECK(names(browse_one(what)) == Names{"Objects", "v", "f"});
    what.reference_type_id = NodeId{};
    CHECK(names(browse_one(what)) == Names{"Objects", "FolderType", "v", "f"});
}

TEST_CASE_METHOD(ViewFixture, "Browse answers for each node with its own status")
{
    const auto status_of = [&](const auto& change) {
        BrowseDescription what = description(node("folder"));
        change(what);
        return browse_one(what).status_code;
    };
    using What = BrowseDescription;
    CHECK(status_of([](What& w) { w.node_id = NodeId{}; }) == status::Bad_NodeIdInvalid);
    CHECK(status_of([](What& w) { w.node_id = NodeId{9, 1U}; }) == status::Bad_NodeIdUnknown);
    CHECK(status_of([](What& w) { w.browse_direction = BrowseDirection::Invalid; }) ==
          status::Bad_BrowseDirectionInvalid);
    CHECK(status_of([](What& w) { w.browse_direction = BrowseDirection{-1}; }) ==
          status::Bad_BrowseDirectionInvalid);
    CHECK(status_of([](What& w) {
              w.reference_type_id = NodeId{0, id::ObjectsFolder};
          }) == status::Bad_ReferenceTypeIdInvalid);
    CHECK(status_of([](What& w) {
              w.reference_type_id = NodeId{9, "x"};
          }) == status::Bad_ReferenceTypeIdInvalid);
    const BrowseResponse mixed =
        browse_all({description(NodeId{9, 1U}), description(NodeId{0, id::ObjectsFolder})});
    CHECK(mixed.results[0].status_code == status::Bad_NodeIdUnknown);
    CHECK(mixed.results[1].status_code == status::Good);
}

TEST_CASE_METHOD(ViewFixture, "Requests with nothing or too much to do are refused whole")
{
    limits.operations = {2, 2, 2, 2, 2};
    ViewContext view = context();
    BrowseRequest request;
    BrowseResponse response;
    CHECK(browse(view, request, response) == status::Bad_NothingToDo);
    request.nodes_to_browse.resize(3);
    CHECK(browse(view, request, response) == status::Bad_TooManyOperations);
    BrowseNextRequest next_request;
    BrowseNextResponse next_response;
    CHECK(browse_next(view, next_request, next_response) == status::Bad_NothingToDo);
    next_request.continuation_points.resize(3);
    CHECK(browse_next(view, next_request, next_response) == status::Bad_TooManyOperations);
    TranslateBrowsePathsToNodeIdsRequest translate_request;
    CHECK(check_translate(view, translate_request) == status::Bad_NothingToDo);
    translate_request.browse_paths.resize(3);
    CHECK(check_translate(view, translate_request) == status::Bad_TooManyOperations);
}

TEST_CASE_METHOD(ViewFixture, "A browse goes on where it stopped, whatever the size of its parts",
                 "[unit:View Basic][unit:View Basic 2]"
                 "[unit:View Minimum Continuation Point 01]")
{
    add_children(7);
    const std::uint32_t most = GENERATE(1U, 2U, 3U, 6U, 7U, 8U);
    BrowseResult result = browse_one(description(node("folder")), most);
    Names all = names(result);
    while (!result.continuation_point.is_null()) {
        CHECK(result.references.size() == most);
        result = next(result.continuation_point);
        REQUIRE_FALSE(result.references.empty());
        const Names more = names(result);
        all.insert(all.end(), more.begin(), more.end());
    }
    CHECK(all == Names{"v0", "v1", "v2", "v3", "v4", "v5", "v6"});
    CHECK(ViewPart::of(session).size() == 0);
}

TEST_CASE_METHOD(ViewFixture, "The server's own limit makes continuation points too")
{
    add_children(5);
    limits.max_references_per_node = 4;
    CHECK(browse_one(description(node("folder"))).references.size() == 4);
    CHECK(browse_one(description(node("folder")), 1000).references.size() == 4);
}

TEST_CASE_METHOD(ViewFixture, "Continuation points are limited, single use and of one session")
{
    add_children(3);
    limits.max_browse_continuation_points = 2;
    const BrowseDescription what = description(node("folder"));
    const BrowseResponse response = browse_all({what, what, what}, 1);
    CHECK(response.results[1].status_code == status::Good);
    CHECK(response.results[2].status_code == status::Bad_NoContinuationPoints);
    CHECK(response.results[2].references.empty());

    const ByteString first = response.results[0].continuation_point;
    const ByteString second = response.results[1].continuation_point;
    CHECK(first != second);
    Session other{1000, 1000};
    ViewContext view{space, {space, user, control}, limits, random, other};
    BrowseNextRequest request;
    request.continuation_points = {first, ByteString{}, ByteString{second.span().first(15)}};
    BrowseNextResponse next_response;
    REQUIRE(browse_next(view, request, next_response) == status::Good);
    for (const BrowseResult& result : next_response.results) {
        CHECK(result.status_code == status::Bad_ContinuationPointInvalid);
    }

    CHECK(names(next(first)) == Names{"v1"});
    CHECK(next(first).status_code == status::Bad_ContinuationPointInvalid);
    static_cast<void>(next(second, true));
    CHECK(next(second).status_code == status::Bad_ContinuationPointInvalid);
}

TEST_CASE_METHOD(ViewFixture, "A new request frees the points of earlier ones that it needs")
{
    add_children(3);
    limits.max_browse_continuation_points = 1;
    const BrowseResult old = browse_one(description(node("folder")), 1);
    const BrowseResult young = browse_one(description(node("folder")), 1);
    CHECK(young.status_code == status::Good);
    CHECK(next(old.continuation_point).status_code == status::Bad_ContinuationPointInvalid);
    CHECK(names(next(young.continuation_point)) == Names{"v1"});
}

TEST_CASE_METHOD(ViewFixture, "Continuation points are charged to the session")
{
    add_children(3);
    Session poor{10, 10};
    ViewContext view{space, {space, user, control}, limits, random, poor};
    BrowseRequest request;
    request.nodes_to_browse = {description(node("folder"))};
    request.requested_max_references_per_node = 1;
    BrowseResponse response;
    REQUIRE(browse(view, request, response) == status::Good);
    CHECK(response.results[0].status_code == status::Bad_NoContinuationPoints);
    for (int i = 0; i < 10'000; ++i) {
        const BrowseResult result = browse_one(description(node("folder")), 1);
        REQUIRE(result.status_code == status::Good);
    }
}

TEST_CASE_METHOD(ViewFixture, "Nodes may vanish between Browse and BrowseNext")
{
    add_children(6);
    const BrowseResult result = browse_one(description(node("folder")), 2);
    SECTION("some references")
    {
        REQUIRE(space.remove(find("v0")));
        REQUIRE(space.remove(find("v2")));
        CHECK(names(next(result.continuation_point)) == Names{"v3", "v4"});
    }
    SECTION("the node itself")
    {
        REQUIRE(space.remove(folder));
        CHECK(next(result.continuation_point).status_code == status::Bad_NodeIdUnknown);
        add_folder("another", objects);
        CHECK(next(result.continuation_point).status_code == status::Bad_ContinuationPointInvalid);
    }
    SECTION("so many that the list is put together again")
    {
        for (int i = 0; i < 5; ++i) {
            REQUIRE(space.remove(find("v" + std::to_string(i))));
        }
        for (int i = 10; i < 30; ++i) {
            add_int32("v" + std::to_string(i), folder);
        }
        CHECK(next(result.continuation_point).status_code == status::Bad_ContinuationPointInvalid);
    }
}

TEST_CASE_METHOD(ViewFixture, "One request cannot ask for all the server's memory or time")
{
    add_children(100);
    ViewContext view = context();
    view.references_left = 150;
    BrowseRequest request;
    request.nodes_to_browse = {description(node("folder")), description(node("folder")),
                               description(node("folder"))};
    BrowseResponse response;
    REQUIRE(browse(view, request, response) == status::Good);
    CHECK(response.results[0].references.size() == 100);
    CHECK(response.results[1].references.size() == 50);
    CHECK(response.results[2].references.empty());
    CHECK(names(next(response.results[1].continuation_point)).front() == "v50");
    CHECK(next(response.results[2].continuation_point).references.size() == 100);

    view.visits_left = 60;
    request.nodes_to_browse = {description(node("folder"))};
    request.nodes_to_browse[0].node_class_mask = static_cast<std::uint32_t>(NodeClass::View);
    response = {};
    REQUIRE(browse(view, request, response) == status::Good);
    CHECK(response.results[0].references.empty());
    REQUIRE_FALSE(response.results[0].continuation_point.is_null());
    CHECK(next(response.results[0].continuation_point).continuation_point.is_null());
}

TEST_CASE_METHOD(ViewFixture, "A hidden node is neither told of nor found")
{
    add_int32("secret", folder);
    add_int32("v", folder);
    const HidesOne hides{node("secret")};
    control = &hides;
    CHECK(names(browse_one(description(node("folder")))) == Names{"v"});
    CHECK(browse_one(description(node("secret"))).status_code == status::Bad_NodeIdUnknown);
    CHECK(translate(node("folder"), {element({ns, "secret"}, id::Organizes)}).status_code ==
          status::Bad_NoMatch);
    CHECK(translate(node("secret"), {element({0, "x"}, 0)}).status_code ==
          status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(ViewFixture, "Browse paths lead to nodes", "[unit:View TranslateBrowsePath]")
{
    add_int32("v", add_folder("inner", folder));
    const auto target = [](const BrowsePathResult& result) {
        REQUIRE(result.status_code == status::Good);
        REQUIRE(result.targets.size() == 1);
        CHECK(result.targets[0].remaining_path_index == UINT32_MAX);
        return result.targets[0].target_id.node_id;
    };
    const NodeId start{0, id::ObjectsFolder};
    const RelativePathElement to_folder = element({ns, "folder"}, id::HierarchicalReferences);
    const RelativePathElement to_inner = element({ns, "inner"}, id::Organizes);
    const RelativePathElement to_v = element({ns, "v"}, 0);
    CHECK(target(translate(start, {to_folder})) == node("folder"));
    CHECK(target(translate(start, {to_folder, to_inner, to_v})) == node("v"));
    const RelativePathElement back = element({ns, "folder"}, id::Organizes, true);
    CHECK(target(translate(node("inner"), {back, to_inner})) == node("inner"));
    const RelativePathElement to_type = element({0, "FolderType"}, id::HasTypeDefinition);
    CHECK(target(translate(start, {to_type})) == NodeId{0, id::FolderType});
    CHECK(target(translate(NodeId{0, id::Server}, {element({0, "ServerStatus"}, id::Aggregates),
                                                   element({0, "State"}, id::HasComponent)})) ==
          NodeId{0, id::Server_ServerStatus_State});
}

TEST_CASE_METHOD(ViewFixture, "Browse paths that lead nowhere say why")
{
    const NodeId start = node("folder");
    const RelativePathElement good = element({ns, "v"}, id::Organizes);
    add_children(3);
    CHECK(translate(NodeId{}, {good}).status_code == status::Bad_NodeIdInvalid);
    CHECK(translate(NodeId{ns, 1U}, {good}).status_code == status::Bad_NodeIdUnknown);
    CHECK(translate(start, {}).status_code == status::Bad_NothingToDo);
    CHECK(translate(start, {good}).status_code == status::Bad_NoMatch);
    CHECK(translate(start, {element({}, id::Organizes)}).status_code ==
          status::Bad_BrowseNameInvalid);
    CHECK(translate(start, {element({}, id::Organizes), good}).status_code ==
          status::Bad_BrowseNameInvalid);
    CHECK(translate(start, {element({ns, "v0"}, id::ObjectsFolder)}).status_code ==
          status::Bad_ReferenceTypeIdInvalid);
    RelativePathElement exact = element({ns, "v0"}, id::HierarchicalReferences);
    exact.include_subtypes = false;
    CHECK(translate(start, {exact}).status_code == status::Bad_NoMatch);
    CHECK(translate(start, {element({0, "v0"}, id::Organizes)}).status_code == status::Bad_NoMatch);
}

TEST_CASE_METHOD(ViewFixture, "Browse paths that branch or go round are bounded")
{
    constexpr int count = 20;
    add_hub(count);
    const RelativePathElement down = element({ns, "same"}, id::Organizes);
    const RelativePathElement up = element({ns, "hub"}, id::Organizes, true);
    limits.max_browse_path_targets = count;
    CHECK(translate(node("hub"), {down}).targets.size() == count);
    // All twenty lead back to one node, which counts once.
    CHECK(translate(node("hub"), {down, up}).targets.size() == 1);
    limits.max_browse_path_targets = count - 1;
    CHECK(translate(node("hub"), {down}).status_code == status::Bad_TooManyMatches);

    limits.max_browse_path_targets = 100;
    Array<RelativePathElement> round;
    for (std::uint32_t i = 0; i < limits.max_browse_path_elements; i += 2) {
        round.push_back(down);
        round.push_back(up);
    }
    CHECK(translate(node("hub"), round).status_code == status::Good);
    round.push_back(down);
    CHECK(translate(node("hub"), round).status_code == status::Bad_QueryTooComplex);
    round.resize(8'000);
    CHECK(translate(node("hub"), round).status_code == status::Bad_QueryTooComplex);

    const BrowsePath path{node("hub"), RelativePath{Array<RelativePathElement>{down, up}}};
    ViewContext view = context();
    view.visits_left = 30;
    CHECK(PathWalk{}.go_on(view, path).value().status_code == status::Bad_QueryTooComplex);
}

TEST_CASE_METHOD(ViewFixture,
                 "Nodes that have no use for an alias keep their NodeIds and take no memory",
                 "[unit:View RegisterNodes]")
{
    ViewContext view = context();
    RegisterNodesRequest request;
    RegisterNodesResponse response;
    CHECK(register_nodes(view, request, response) == status::Bad_NothingToDo);
    request.nodes_to_register = {node("folder"), NodeId{ns, "nowhere"}};
    CHECK(register_nodes(view, request, response) == status::Good);
    CHECK(response.registered_node_ids == request.nodes_to_register);
    request.nodes_to_register.push_back(NodeId{});
    CHECK(register_nodes(view, request, response) == status::Bad_NodeIdInvalid);
    limits.operations.max_nodes_per_register_nodes = 2;
    CHECK(register_nodes(view, request, response) == status::Bad_TooManyOperations);
    UnregisterNodesRequest end;
    CHECK(unregister_nodes(view, end) == status::Bad_NothingToDo);
    end.nodes_to_unregister = {node("folder"), node("never registered")};
    CHECK(unregister_nodes(view, end) == status::Good);
    CHECK(session.registered == nullptr);
}

} // namespace busbar::server::detail::view_test
