#include <catch2/catch.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/graft.hpp"
#include "model_fixture.hpp"

namespace busbar::model::node_watch_test {

namespace {

/// Counts what it is told, and watches again until the node is gone.
struct Watch final : NodeWatch {
    void node_changed(NodeIndex node, bool was_removed) override
    {
        CHECK_FALSE(is_watching());
        last = node;
        ++told;
        is_removed = is_removed || was_removed;
        if (const auto call = then) { // which may destroy this
            call();
        }
    }
    /// Returns how often it was told since the last time.
    int take() { return std::exchange(told, 0); }

    int told{0};
    bool is_removed{false};
    NodeIndex last{no_node};
    std::function<void()> then;
};

struct WatchFixture : ModelFixture {
    void watch(NodeIndex node, NodeAspect aspect, Watch& by)
    {
        space.journal().watch(node, aspect, by);
        by.then = [this, node, aspect, &by] {
            if (!by.is_removed) {
                space.journal().watch(node, aspect, by);
            }
        };
    }

    NodeIndex folder{add_folder("folder", objects)};
    NodeIndex variable{add_int32("v", folder)};
    NodeIndex other{add_folder("other", objects)};
    NodeId organizes{0, id::Organizes};
    Watch existence, binding, references, positions;
};

} // namespace

TEST_CASE_METHOD(WatchFixture, "A watch is told of what it watches and of nothing else")
{
    watch(variable, NodeAspect::Existence, existence);
    watch(variable, NodeAspect::Binding, binding);
    watch(variable, NodeAspect::References, references);

    space.bind(variable, 1, 2);
    CHECK(binding.take() == 1);
    CHECK(binding.last == variable);
    space.set_access_level(variable, Access::ReadWrite, Access::Read);
    CHECK(binding.take() == 1);
    space.set_node_access(variable, {});
    CHECK(binding.take() == 1);
    space.set_namespace_restrictions(ns, 1);
    CHECK(binding.take() == 1);
    space.set_namespace_restrictions(static_cast<std::uint16_t>(ns + 1), 1);
    space.bind(space.find(id::Server_ServerStatus_CurrentTime), 1, 2);
    REQUIRE(space.set_value(variable, Variant{3}));
    CHECK(binding.take() == 0);
    CHECK(references.take() == 0);

    REQUIRE(space.add_reference(other, organizes, variable));
    CHECK(references.take() == 1);
    REQUIRE(space.remove_reference(other, organizes, variable));
    CHECK(references.take() == 1);
    add_int32("elsewhere", other);
    CHECK(references.take() == 0);
    const NodeIndex child = add_int32("below", variable);
    CHECK(references.take() == 1);
    REQUIRE(space.remove(child));
    CHECK(references.take() == 1);
    CHECK(binding.take() == 0);
    CHECK(existence.take() == 0);

    REQUIRE(space.remove(folder));
    for (Watch* const each : {&existence, &binding, &references}) {
        CHECK(each->is_removed);
        CHECK(each->told == 1);
        CHECK_FALSE(each->is_watching());
    }
    // A node that comes in its place is another one.
    CHECK(add_int32("w", other) != no_node);
    CHECK(existence.take() + binding.take() + references.take() == 3);
}

TEST_CASE_METHOD(WatchFixture, "Constant nodes can be watched like others")
{
    const NodeIndex time = space.find(id::Server_ServerStatus_CurrentTime);
    watch(time, NodeAspect::Binding, binding);
    watch(objects, NodeAspect::References, references);
    space.bind(time, 1, 2);
    CHECK(binding.take() == 1);
    add_folder("f", objects);
    CHECK(references.take() == 1);
}

TEST_CASE_METHOD(WatchFixture, "Positions of references are told of only when they move")
{
    watch(folder, NodeAspect::ReferencePositions, positions);
    for (int i = 0; i < 100; ++i) {
        add_int32(std::to_string(i), folder);
    }
    for (int i = 0; i < 99; ++i) {
        REQUIRE(space.remove(find(std::to_string(i))));
    }
    CHECK(positions.take() == 0);
    for (int i = 0; i < 100; ++i) {
        add_int32("again" + std::to_string(i), folder);
    }
    CHECK(positions.take() == 1);
    CHECK(children(folder).size() == 102);
}

TEST_CASE_METHOD(WatchFixture, "A watch tells once, and no more when it is stopped or gone")
{
    space.journal().watch(variable, NodeAspect::Binding, binding);
    CHECK(binding.is_watching());
    space.bind(variable, 1, 1);
    space.bind(variable, 1, 2);
    CHECK(binding.take() == 1);

    space.journal().watch(variable, NodeAspect::Binding, binding);
    binding.stop();
    binding.stop();
    {
        Watch gone;
        space.journal().watch(variable, NodeAspect::Binding, gone);
    }
    space.bind(variable, 1, 3);
    CHECK(binding.take() == 0);

    // Who begins anew watches the new node only.
    space.journal().watch(variable, NodeAspect::Binding, binding);
    space.journal().watch(other, NodeAspect::References, binding);
    space.bind(variable, 1, 4);
    CHECK(binding.take() == 0);
    add_int32("x", other);
    CHECK(binding.take() == 1);
}

TEST_CASE_METHOD(WatchFixture, "Watches may come and go while one is told")
{
    std::vector<std::unique_ptr<Watch>> all;
    for (int i = 0; i < 5; ++i) {
        space.journal().watch(variable, NodeAspect::Binding,
                              *all.emplace_back(std::make_unique<Watch>()));
    }
    Watch late;
    Watch* const middle = all[2].get();
    int told = 0;
    for (const auto& each : all) {
        each->then = [&told] { ++told; };
    }
    SECTION("all of them, itself too")
    {
        middle->then = [&] {
            ++told;
            all.clear();
        };
        space.bind(variable, 1, 1);
        CHECK(told >= 1);
        CHECK(told <= 5);
        CHECK(all.empty());
    }
    SECTION("all others")
    {
        middle->then = [&] {
            ++told;
            for (const std::size_t i : {0U, 1U, 3U, 4U}) {
                all[i]->stop();
            }
        };
        space.bind(variable, 1, 1);
        CHECK(told >= 1);
        CHECK(told < 5);
        space.bind(variable, 1, 2);
        CHECK(middle->told == 1);
    }
    SECTION("one more, that is told next time")
    {
        middle->then = [&] { space.journal().watch(variable, NodeAspect::Binding, late); };
        space.bind(variable, 1, 1);
        CHECK(told == 4);
        CHECK(late.told == 0);
        space.bind(variable, 1, 2);
        CHECK(late.told == 1);
    }
    SECTION("at the removal of the node")
    {
        middle->then = [&] { all[4].reset(); };
        REQUIRE(space.remove(folder));
        CHECK(told >= 3);
    }
}

TEST_CASE_METHOD(WatchFixture, "Watches go with an AddressSpace that is moved and end with it")
{
    watch(variable, NodeAspect::Existence, existence);
    std::optional<AddressSpace> moved{std::move(space)};
    REQUIRE(moved->add_reference(moved->find(id::Server), organizes, variable));
    moved->bind(variable, 1, 1);
    CHECK(existence.take() == 0);
    moved->journal().watch(variable, NodeAspect::Binding, binding);
    moved->journal().watch(variable, NodeAspect::Binding, references);
    moved->bind(variable, 1, 1);
    CHECK(binding.take() + references.take() == 2);

    moved->journal().watch(variable, NodeAspect::Binding, binding);
    SECTION("destroyed")
    {
        moved.reset();
    }
    SECTION("assigned to")
    {
        *moved = AddressSpace{};
    }
    CHECK(existence.told == 0);
    CHECK(binding.told == 0);
    CHECK_FALSE(existence.is_watching());
    CHECK_FALSE(binding.is_watching());
}

TEST_CASE_METHOD(WatchFixture, "Nodes that come at once are told of, and that they are taken back")
{
    watch(objects, NodeAspect::References, references);
    watch(other, NodeAspect::References, positions);
    {
        detail::Graft graft{space};
        const NodeIndex node =
            graft.create(NodeId{ns, "n"}, QualifiedName{ns, "n"}, NodeClass::Object).value();
        watch(node, NodeAspect::Existence, existence);
        graft.add_reference(objects, space.find(id::Organizes), node);
        graft.add_reference(other, space.find(id::Organizes), node);
        graft.link();
        CHECK(references.take() == 1);
        CHECK(positions.take() == 1);
    }
    CHECK(references.take() >= 1);
    CHECK(positions.take() >= 1);
    CHECK(existence.is_removed);
}

} // namespace busbar::model::node_watch_test
