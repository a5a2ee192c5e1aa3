#include <catch2/catch.hpp>

#include <busbar/model/relative_path.hpp>
#include <busbar/types/ids.hpp>

#include "model/model_fixture.hpp"
#include "server/hierarchy.hpp"
#include "server/view_context.hpp"
#include "server/view_part.hpp"
#include "support/seeded_random.hpp"

namespace busbar::server::detail {

namespace {

using Names = std::vector<std::string>;

/// Hides the nodes of one name.
class HidesOne final : public AccessControl {
public:
    explicit HidesOne(NodeId hidden) : hidden_{std::move(hidden)} {}
    [[nodiscard]] bool may_browse(const UserIdentity&, const NodeId& node) const override
    {
        return node != hidden_;
    }
    [[nodiscard]] std::uint8_t user_access_level(const UserIdentity&, const NodeId&,
                                                 std::uint8_t access_level) const override
    {
        return access_level;
    }

private:
    NodeId hidden_;
};

struct ViewFixture : model::ModelFixture {
    ServerLimits limits;
    test::SeededRandom random{1};
    Session session{1U << 20U};
    UserIdentity user;
    const AccessControl* control{nullptr};
    model::NodeIndex folder{add_folder("folder", objects)};

    [[nodiscard]] ViewContext context()
    {
        return {space, {user, control}, limits, random, session};
    }
    [[nodiscard]] NodeId node(const std::string& name) const { return {ns, String{name}}; }
    void add_children(int count)
    {
        for (int i = 0; i < count; ++i) {
            add_int32("v" + std::to_string(i), folder);
        }
    }
    [[nodiscard]] static BrowseDescription description(NodeId id)
    {
        BrowseDescription result;
        result.node_id = std::move(id);
        result.reference_type_id = NodeId{0, id::HierarchicalReferences};
        result.include_subtypes = true;
        result.result_mask = static_cast<std::uint32_t>(BrowseResultMask::All);
        return result;
    }
    [[nodiscard]] BrowseResponse browse_all(Array<BrowseDescription> nodes, std::uint32_t most = 0)
    {
        BrowseRequest request;
        request.nodes_to_browse = std::move(nodes);
        request.requested_max_references_per_node = most;
        BrowseResponse response;
        ViewContext view = context();
        REQUIRE(browse(view, request, response) == status::Good);
        return response;
    }
    [[nodiscard]] BrowseResult browse_one(const BrowseDescription& what, std::uint32_t most = 0)
    {
        return browse_all({what}, most).results[0];
    }
    [[nodiscard]] BrowseResult next(const ByteString& point, bool release = false)
    {
        BrowseNextRequest request;
        request.continuation_points = {point};
        request.release_continuation_points = release;
        BrowseNextResponse response;
        ViewContext view = context();
        REQUIRE(browse_next(view, request, response) == status::Good);
        CHECK(response.results.size() == (release ? 0 : 1));
        return release ? BrowseResult{} : response.results[0];
    }
    [[nodiscard]] static Names names(const BrowseResult& result)
    {
        Names all;
        for (const ReferenceDescription& reference : result.references) {
            all.push_back(reference.browse_name.name.str());
        }
        return all;
    }
    [[nodiscard]] static RelativePathElement element(const QualifiedName& name, std::uint32_t type,
                                                     bool is_inverse = false)
    {
        RelativePathElement result;
        result.reference_type_id = type == 0 ? NodeId{} : NodeId{0, type};
        result.include_subtypes = true;
        result.is_inverse = is_inverse;
        result.target_name = name;
        return result;
    }
    [[nodiscard]] BrowsePathResult translate(NodeId start, Array<RelativePathElement> elements)
    {
        TranslateBrowsePathsToNodeIdsRequest request;
        request.browse_paths.emplace_back(
            BrowsePath{std::move(start), RelativePath{std::move(elements)}});
        TranslateBrowsePathsToNodeIdsResponse response;
        ViewContext view = context();
        REQUIRE(translate_browse_paths(view, request, response) == status::Good);
        return response.results[0];
    }
};

} // namespace

TEST_CASE_METHOD(ViewFixture, "Browse tells of references what the ResultMask asks for")
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
    TranslateBrowsePathsToNodeIdsResponse translate_response;
    CHECK(translate_browse_paths(view, translate_request, translate_response) ==
          status::Bad_NothingToDo);
    translate_request.browse_paths.resize(3);
    CHECK(translate_browse_paths(view, translate_request, translate_response) ==
          status::Bad_TooManyOperations);
}

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
    REQUIRE(space.add_reference(leaf, NodeId{0, id::AlwaysGeneratesEvent}, outside));
    REQUIRE(space.add_reference(leaf, NodeId{0, id::AlwaysGeneratesEvent}, inside));
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

TEST_CASE_METHOD(ViewFixture, "A browse goes on where it stopped, whatever the size of its parts")
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
    Session other{1000};
    ViewContext view{space, {user, control}, limits, random, other};
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
    Session poor{10};
    ViewContext view{space, {user, control}, limits, random, poor};
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

TEST_CASE_METHOD(ViewFixture, "Browse paths lead to nodes")
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
    const model::NodeIndex hub = add_folder("hub", objects);
    constexpr int count = 20;
    for (int i = 0; i < count; ++i) {
        model::NewNode same =
            named("same" + std::to_string(i), add_folder(std::to_string(i), folder));
        same.browse_name = QualifiedName{ns, "same"};
        const model::NodeIndex added = space.add_folder(same).value();
        REQUIRE(space.add_reference(hub, NodeId{0, id::Organizes}, added));
    }
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

    TranslateBrowsePathsToNodeIdsRequest request;
    request.browse_paths.emplace_back(
        BrowsePath{node("hub"), RelativePath{Array<RelativePathElement>{down, up}}});
    TranslateBrowsePathsToNodeIdsResponse response;
    ViewContext view = context();
    view.visits_left = 30;
    REQUIRE(translate_browse_paths(view, request, response) == status::Good);
    CHECK(response.results[0].status_code == status::Bad_QueryTooComplex);
}

TEST_CASE_METHOD(ViewFixture, "Registered nodes keep their NodeIds and take no memory")
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
}

} // namespace busbar::server::detail
