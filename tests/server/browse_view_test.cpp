#include <catch2/catch.hpp>

#include <busbar/model/relative_path.hpp>

#include "server/rights/hierarchy.hpp"
#include "view_fixture.hpp"

namespace busbar::server::detail::browse_view_test {

TEST_CASE_METHOD(ViewFixture, "Only Views without version can be browsed through")
{
    REQUIRE(space.add_view(named("view", space.find(id::ViewsFolder))));
    BrowseRequest request;
    request.nodes_to_browse = {description(node("folder"))};
    BrowseResponse response;
    const auto result = [&] {
        ViewContext view = context();
        return browse(view, request, response);
    };
    request.view.view_id = node("folder");
    CHECK(result() == status::Bad_ViewIdUnknown);
    request.view.view_id = node("view");
    CHECK(result() == status::Good);
    request.view.view_version = 1;
    CHECK(result() == status::Bad_ViewVersionInvalid);
    request.view.timestamp = DateTime{1};
    CHECK(result() == status::Bad_ViewParameterMismatch);
    request.view.view_version = 0;
    CHECK(result() == status::Bad_ViewTimestampInvalid);
}

TEST_CASE_METHOD(ViewFixture, "A View shows only what it contains")
{
    const model::NodeIndex view =
        space.add_view(named("view", space.find(id::ViewsFolder))).value();
    const model::NodeIndex inside = add_folder("inside", folder);
    const model::NodeIndex outside = add_folder("outside", folder);
    const model::NodeIndex leaf = add_int32("leaf", inside);
    REQUIRE(space.add_reference(view, NodeId{0, id::Organizes}, inside));
    // A reference that is not hierarchical and is in every size of namespace 0.
    REQUIRE(space.add_reference(leaf, NodeId{0, id::HasEncoding}, outside));
    REQUIRE(space.add_reference(leaf, NodeId{0, id::HasEncoding}, inside));
    const auto browse_in_view = [&](const std::string& name) {
        BrowseRequest request;
        BrowseDescription all = description(node(name));
        all.reference_type_id = {};
        all.browse_direction = BrowseDirection::Both;
        request.nodes_to_browse = {all};
        request.view.view_id = node("view");
        BrowseResponse response;
        ViewContext context_of_view = context();
        REQUIRE(browse(context_of_view, request, response) == status::Good);
        return response.results[0];
    };
    CHECK(names(browse_in_view("view")) == Names{"inside"});
    // The folder above is not in the View, nor is the type.
    CHECK(names(browse_in_view("inside")) == Names{"leaf", "view", "leaf"});
    CHECK(names(browse_in_view("leaf")) == Names{"inside", "inside"});
    for (const char* name : {"folder", "outside"}) {
        CHECK(browse_in_view(name).status_code == status::Bad_NodeNotInView);
    }
    CHECK(browse_in_view("none").status_code == status::Bad_NodeIdUnknown);
}

TEST_CASE_METHOD(ViewFixture, "BrowseNext stays in the View, until that is gone")
{
    const model::NodeIndex view =
        space.add_view(named("view", space.find(id::ViewsFolder))).value();
    add_children(3);
    const model::NodeIndex other = add_folder("other", objects);
    REQUIRE(space.add_reference(view, NodeId{0, id::Organizes}, folder));
    BrowseRequest request;
    request.nodes_to_browse = {description(node("folder"))};
    request.nodes_to_browse[0].reference_type_id = {};
    request.nodes_to_browse[0].browse_direction = BrowseDirection::Both;
    request.requested_max_references_per_node = 1;
    request.view.view_id = node("view");
    BrowseResponse response;
    const auto first = [&] {
        ViewContext context_of_view = context();
        REQUIRE(browse(context_of_view, request, response) == status::Good);
        return response.results[0].continuation_point;
    };
    const BrowseResult second = next(first());
    CHECK(names(second) == Names{"v1"});
    // Nodes that come meanwhile do not end the browse.
    add_int32("late", other);
    CHECK(names(next(second.continuation_point)) == Names{"v2"});
    const ByteString point = first();
    REQUIRE(space.remove(view));
    CHECK(next(point).status_code == status::Bad_ContinuationPointInvalid);
}

TEST_CASE_METHOD(ViewFixture, "A View may have a version")
{
    const model::NodeIndex view =
        space.add_view(named("view", space.find(id::ViewsFolder))).value();
    model::NewNode property;
    property.id = NodeId{ns, "version"};
    property.browse_name = QualifiedName{0, "ViewVersion"};
    property.parent = view;
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::UInt32};
    variable.value = std::uint32_t{3};
    REQUIRE(space.add_property(property, variable));
    BrowseRequest request;
    request.nodes_to_browse = {description(node("view"))};
    request.view.view_id = node("view");
    BrowseResponse response;
    for (const std::uint32_t version : {0U, 1U, 3U}) {
        request.view.view_version = version;
        ViewContext context_of_view = context();
        CHECK(browse(context_of_view, request, response) ==
              (version == 1 ? status::Bad_ViewVersionInvalid : status::Good));
    }
}

TEST_CASE_METHOD(ViewFixture, "A View that goes round ends")
{
    const model::NodeIndex view =
        space.add_view(named("view", space.find(id::ViewsFolder))).value();
    const model::NodeIndex a = add_folder("a", folder);
    const model::NodeIndex b = add_folder("b", a);
    REQUIRE(space.add_reference(b, NodeId{0, id::Organizes}, a));
    std::size_t visits = 1'000;
    const model::NodeIndex hierarchical = space.find(id::HierarchicalReferences);
    CHECK_FALSE(is_below(space, b, view, hierarchical, visits));
    CHECK(is_below(space, b, folder, hierarchical, visits));
    visits = 1;
    CHECK_FALSE(is_below(space, b, folder, hierarchical, visits));
    CHECK(visits == 0);
}

TEST_CASE_METHOD(ViewFixture, "Browse paths as text lead to nodes")
{
    const model::NodeIndex boiler = add_folder("Boiler", folder);
    add_int32("Block.Output", boiler);
    const auto lead = [&](const NodeId& start, const char* text) {
        auto path = model::parse_relative_path(text, space);
        REQUIRE(path);
        const BrowsePathResult result = translate(start, std::move(path->elements));
        return result.targets.empty() ? NodeId{} : result.targets[0].target_id.node_id;
    };
    const NodeId output = node("Block.Output");
    const NodeId object_folder{0, id::ObjectsFolder};
    CHECK(lead(object_folder, "/1:folder/1:Boiler/1:Block&.Output") == output);
    CHECK(lead(object_folder, "/1:folder/1:Boiler<HasComponent>1:Block&.Output") == NodeId{});
    CHECK(lead(output, "<!Organizes>1:Boiler<!HierarchicalReferences>1:folder") == node("folder"));
    CHECK(lead(output, "<#!HierarchicalReferences>1:Boiler") == NodeId{});
    CHECK(lead(object_folder, "/Server.ServerArray") == NodeId{0, id::Server_ServerArray});
}

TEST_CASE_METHOD(ViewFixture, "The examples of Part 4, A.2 lead to nodes (Table A.2)")
{
    const NodeId connected_to = node("ConnectedTo");
    REQUIRE(space.add_reference_type(
        named("ConnectedTo", space.find(id::NonHierarchicalReferences)), {}));
    add_int32("Block.Output", folder);
    const model::NodeIndex truck = add_folder("Truck", folder);
    add_int32("Wheel", truck);
    model::NewNode version = named("Truck.NodeVersion", truck);
    version.browse_name = QualifiedName{0, "NodeVersion"};
    model::NewVariable text;
    text.data_type = NodeId{0, id::String};
    REQUIRE(space.add_property(version, text));
    const model::NodeIndex boiler = add_folder("Boiler", objects);
    add_int32("HeatSensor", boiler);
    REQUIRE(space.add_reference(folder, connected_to, boiler));
    const auto targets = [&](const NodeId& start, std::string_view path) {
        INFO(path);
        const auto parsed = model::parse_relative_path(path, space);
        REQUIRE(parsed);
        const BrowsePathResult result = translate(start, parsed->elements);
        CHECK(result.status_code == status::Good);
        return result.targets.size() == 1 ? result.targets[0].target_id.node_id : NodeId{};
    };
    const NodeId start = node("folder");
    REQUIRE(ns == 1);
    CHECK(targets(start, "/1:Block&.Output") == node("Block.Output"));
    CHECK(targets(start, "/1:Truck.0:NodeVersion") == node("Truck.NodeVersion"));
    CHECK(targets(start, "/1:Truck.NodeVersion") == node("Truck.NodeVersion"));
    CHECK(targets(start, "<1:ConnectedTo>1:Boiler/1:HeatSensor") == node("HeatSensor"));
    CHECK(targets(node("Boiler"), "<!1:ConnectedTo>1:folder") == start);
    CHECK(targets(node("Truck"), "<0:Organizes>1:Wheel") == node("Wheel"));
    CHECK(targets(node("Wheel"), "<!Organizes>1:Truck") == node("Truck"));
    CHECK(targets(node("Wheel"), "<!HierarchicalReferences>1:Truck") == node("Truck"));
    // Part 4, 5.9.4.2: the Service wants a name in the end, which the text can leave out.
    for (const char* const open : {"<1:ConnectedTo>1:Boiler/", "<0:HasChild>"}) {
        const auto parsed = model::parse_relative_path(open, space);
        REQUIRE(parsed);
        CHECK(translate(start, parsed->elements).status_code == status::Bad_BrowseNameInvalid);
    }
}

} // namespace busbar::server::detail::browse_view_test
