#include <catch2/catch.hpp>

#include "view_fixture.hpp"

namespace busbar::server::detail::view_turns_test {

namespace {

/// A Browse of "folder", turn by turn.
struct TurnsFixture : ViewFixture {
    void begin()
    {
        request.nodes_to_browse = {description(node("folder"))};
        REQUIRE(work.begin(view, request, response) == status::Good);
    }
    /// One turn for about so many references; true if that is all.
    bool go_on(std::size_t references)
    {
        view.turn = Turn{Turn::units_of_reference * references};
        const bool is_complete = work.go_on(view, request, response);
        // What the session pays for.
        CHECK(view.room == static_cast<std::ptrdiff_t>(response.results[0].references.capacity()));
        return is_complete;
    }

    BrowseRequest request;
    BrowseResponse response;
    BrowseWork work;
    ViewContext view{context()};
};

} // namespace

TEST_CASE_METHOD(ViewFixture, "a Browse says the same in however many turns")
{
    add_children(400);
    BrowseDescription instances = description(NodeId{0, id::BaseDataVariableType});
    instances.reference_type_id = {};
    instances.browse_direction = BrowseDirection::Both;
    BrowseDescription few = description(node("folder"));
    few.node_class_mask = static_cast<std::uint32_t>(NodeClass::Method);
    BrowseRequest request;
    request.nodes_to_browse = {description(node("folder")), instances, description(NodeId{9, 1U}),
                               few, description(NodeId{0, id::ObjectsFolder})};
    const auto most = GENERATE(0U, 1U, 150U);
    request.requested_max_references_per_node = most;
    const auto browse_in = [&](std::size_t units) {
        ViewContext view = context();
        view.turn = Turn{units};
        BrowseResponse response;
        REQUIRE(browse(view, request, response) == status::Good);
        return response;
    };
    const BrowseResponse whole = browse_in(Turn{}.left());
    REQUIRE(whole.results[0].references.size() == (most == 0 ? 400 : most));
    for (const std::size_t units : {std::size_t{1}, std::size_t{60}, std::size_t{4'000}}) {
        const BrowseResponse parts = browse_in(units);
        for (std::size_t i = 0; i < whole.results.size(); ++i) {
            CAPTURE(units, i);
            CHECK(parts.results[i].status_code == whole.results[i].status_code);
            CHECK(parts.results[i].references == whole.results[i].references);
            CHECK(parts.results[i].continuation_point.empty() ==
                  whole.results[i].continuation_point.empty());
        }
    }
}

TEST_CASE_METHOD(TurnsFixture, "what a Browse has found outlasts the nodes that it found")
{
    add_children(100);
    for (int i = 0; i < 100; ++i) { // a block of their own each, which goes with them
        add_int32("a name that is too long to lie anywhere but in memory of its own " +
                      std::to_string(i),
                  folder);
    }
    begin();
    REQUIRE_FALSE(go_on(150));
    const Names before = names(response.results[0]);
    REQUIRE(before.size() > 120);
    const auto last = response.results[0].references.end() - 1;
    const NodeId found = last->node_id.node_id;
    REQUIRE(space.remove(space.find(found)));
    for (int i = 0; i < 200; ++i) { // in the memory of the one that is gone
        add_int32("another name, as long as the others are, that lies in its memory " +
                      std::to_string(i),
                  objects);
    }
    CHECK(names(response.results[0]) == before);
    CHECK(last->node_id.node_id == found);
}

TEST_CASE_METHOD(TurnsFixture, "what a Browse finds when it begins again outlasts its nodes, too")
{
    const std::string long_name = "a name that is too long to lie anywhere but in its own memory ";
    const auto add = [&](int i) { return add_int32(long_name + std::to_string(i), folder); };
    std::vector<model::NodeIndex> first;
    for (int i = 0; i < 100; ++i) {
        first.push_back(add(i));
    }
    begin();
    REQUIRE_FALSE(go_on(50));
    const std::size_t found_first = response.results[0].references.size();
    REQUIRE(found_first >= 40);
    for (std::size_t i = 0; i < 80; ++i) { // so that the rest is put together when there are more
        REQUIRE(space.remove(first[i]));
    }
    for (int i = 100; i < 300; ++i) {
        static_cast<void>(add(i));
    }
    REQUIRE_FALSE(go_on(150));
    const Names before = names(response.results[0]);
    REQUIRE(before.size() > found_first);
    REQUIRE(before[0] == long_name + "80"); // it has begun again
    REQUIRE(space.remove(first[80]));
    for (int i = 0; i < 10; ++i) {
        add_int32("another name, as long as the others are, that lies in its memory " +
                      std::to_string(i),
                  objects);
    }
    CHECK(names(response.results[0]) == before);
}

TEST_CASE_METHOD(TurnsFixture, "a node that changes between two turns is browsed as it is then")
{
    add_children(100);
    begin();
    REQUIRE_FALSE(go_on(10));
    CHECK(response.results[0].references.size() < 100);
    add_int32("late", folder);
    REQUIRE(go_on(1'000));
    CHECK(names(response.results[0]).size() == 101);
    CHECK(view.references_left == 200'000 - 101);
}

TEST_CASE_METHOD(ViewFixture, "a browse path goes on where its turn ended")
{
    constexpr int count = 20;
    add_hub(count);
    const RelativePathElement down = element({ns, "same"}, id::Organizes);
    const RelativePathElement up = element({ns, "hub"}, id::Organizes, true);
    const BrowsePath path{node("hub"),
                          RelativePath{Array<RelativePathElement>{down, up, down, up, down}}};
    std::size_t turns = 0;
    /// Removes `gone` behind the given turn, if that is reached.
    const auto walk_and_remove = [&](const std::string& gone, std::size_t behind) {
        PathWalk walk;
        std::optional<BrowsePathResult> result;
        for (turns = 0; !result; ++turns) {
            REQUIRE(turns < 1'000);
            ViewContext view = context();
            view.turn = Turn{1};
            result = walk.go_on(view, path);
            CHECK(walk.held() <= 4 * count * sizeof(model::NodeHandle));
            if (turns == behind) {
                REQUIRE(space.remove(space.find(node(gone))));
            }
        }
        return *std::move(result);
    };
    const BrowsePathResult whole = walk_and_remove({}, SIZE_MAX);
    CHECK(whole.targets == translate(node("hub"), {down, up, down, up, down}).targets);
    CHECK(whole.targets.size() == count);
    const std::size_t all_turns = turns;
    CHECK(all_turns >= 2 * (count - 1));

    SECTION("of what is removed meanwhile it tells nothing")
    {
        // On the way up from its neighbours.
        const BrowsePathResult less = walk_and_remove("same10", 25);
        CHECK(less.status_code == status::Good);
        CHECK(less.targets.size() == count - 1);
    }
    SECTION("of targets that are removed it tells nothing")
    {
        const std::size_t behind = GENERATE_COPY(range(std::size_t{0}, all_turns - 1));
        CAPTURE(behind);
        const BrowsePathResult less = walk_and_remove("same10", behind);
        CHECK(less.status_code == status::Good);
        CHECK(less.targets.size() == count - 1);
        for (const BrowsePathTarget& target : less.targets) {
            CHECK(space.find(target.target_id.node_id) != model::no_node);
        }
    }
}

TEST_CASE_METHOD(ViewFixture, "a browse path whose targets all go away matches nothing")
{
    add_hub(2);
    add_folder("leaf", space.find(node("same0")));
    const BrowsePath path{node("hub"), RelativePath{Array<RelativePathElement>{
                                           element({ns, "same"}, id::Organizes),
                                           element({ns, "leaf"}, id::Organizes)}}};
    PathWalk walk;
    ViewContext view = context();
    view.turn = Turn{1};
    // The leaf is found, same1 has not been looked at.
    REQUIRE_FALSE(walk.go_on(view, path));
    const model::NodeIndex leaf = space.find(node("leaf"));
    REQUIRE(space.remove(leaf));
    SECTION("") {}
    SECTION("nor does another node in their place")
    {
        REQUIRE(add_folder("stranger", folder) == leaf);
    }
    const auto result = walk.go_on(view, path);
    REQUIRE(result);
    CHECK(result->status_code == status::Bad_NoMatch);
    CHECK(result->targets.empty());
}

} // namespace busbar::server::detail::view_turns_test
