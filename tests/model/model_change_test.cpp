#include <catch2/catch.hpp>

#include "model_fixture.hpp"

namespace busbar::model::model_change_test {

namespace {

using Verb = ModelChangeStructureVerbMask;

constexpr unsigned bits(Verb verb)
{
    return static_cast<unsigned>(verb);
}

struct ChangeFixture : ModelFixture {
    NodeIndex add_version(NodeIndex node)
    {
        NewNode property;
        property.id = space.free_id(ns);
        property.browse_name = QualifiedName{0, "NodeVersion"};
        property.parent = node;
        NewVariable variable;
        variable.data_type = NodeId{0, id::String};
        return space.add_property(property, variable).value();
    }
    /// The bits of the only change, 0 if there is none.
    unsigned only_verb(const NodeId& affected)
    {
        const ModelChanges taken = space.journal().take_changes();
        CHECK(taken.is_complete);
        CHECK(taken.changes.size() <= 1);
        if (taken.changes.empty()) {
            return 0;
        }
        CHECK(taken.changes[0].affected == affected);
        return taken.changes[0].verb;
    }
    NodeIndex folder{add_folder("folder", objects)};
    NodeId folder_id{ns, "folder"};
};

} // namespace

TEST_CASE_METHOD(ChangeFixture, "Only changes of nodes that have a NodeVersion are noted")
{
    CHECK_FALSE(space.journal().has_changes());
    CHECK(space.journal().node_version(folder) == no_node);
    const NodeIndex version = add_version(folder);
    CHECK(space.journal().node_version(folder) == version);
    // The folder itself is new.
    CHECK(only_verb(folder_id) == (bits(Verb::NodeAdded) | bits(Verb::ReferenceAdded)));
    const NodeIndex child = add_int32("child", folder);
    CHECK(space.journal().has_changes());
    CHECK(only_verb(folder_id) == bits(Verb::ReferenceAdded));
    CHECK_FALSE(space.journal().has_changes());
    add_int32("elsewhere", objects);
    CHECK_FALSE(space.journal().has_changes());
    REQUIRE(space.remove(child));
    CHECK(only_verb(folder_id) == bits(Verb::ReferenceDeleted));
    REQUIRE(space.remove(version));
    CHECK(only_verb(folder_id) == bits(Verb::ReferenceDeleted));
    CHECK(space.journal().node_version(folder) == no_node);
    add_int32("unseen", folder);
    CHECK_FALSE(space.journal().has_changes());
}

TEST_CASE_METHOD(ChangeFixture, "References change both ends, and changes of a node are joined")
{
    const NodeIndex other = add_folder("other", objects);
    add_version(folder);
    add_version(other);
    static_cast<void>(space.journal().take_changes());
    REQUIRE(space.add_reference(folder, NodeId{0, id::Organizes}, other));
    REQUIRE(space.remove_reference(folder, NodeId{0, id::Organizes}, other));
    const ModelChanges taken = space.journal().take_changes();
    REQUIRE(taken.changes.size() == 2);
    CHECK(taken.changes[0].affected == folder_id);
    CHECK(taken.changes[1].affected == NodeId{ns, "other"});
    for (const ModelChange& change : taken.changes) {
        CHECK(change.verb == (bits(Verb::ReferenceAdded) | bits(Verb::ReferenceDeleted)));
        CHECK(change.affected_type == NodeId{0, id::FolderType});
    }
}

TEST_CASE_METHOD(ChangeFixture, "A removed node is told of, and another in its place is not it")
{
    add_version(folder);
    static_cast<void>(space.journal().take_changes());
    REQUIRE(space.remove(folder));
    CHECK(only_verb(folder_id) == (bits(Verb::NodeDeleted) | bits(Verb::ReferenceDeleted)));
    for (const char* name : {"a", "b", "c"}) {
        const NodeIndex next = add_folder(name, objects);
        CHECK(space.journal().node_version(next) == no_node);
        add_int32(std::string{name} + "1", next);
    }
    CHECK_FALSE(space.journal().has_changes());
}

TEST_CASE_METHOD(ChangeFixture, "Constant nodes may have a NodeVersion too")
{
    add_version(objects);
    const ModelChanges taken = space.journal().take_changes();
    REQUIRE(taken.changes.size() == 1);
    CHECK(taken.changes[0].affected == NodeId{0, id::ObjectsFolder});
    CHECK(taken.changes[0].affected_type == NodeId{0, id::FolderType});
    CHECK(taken.changes[0].verb == bits(Verb::ReferenceAdded));
}

TEST_CASE_METHOD(ChangeFixture, "The journal is bounded")
{
    std::vector<NodeIndex> nodes;
    for (int i = 0; i < 1'001; ++i) {
        nodes.push_back(add_folder("n" + std::to_string(i), folder));
        add_version(nodes.back());
    }
    ModelChanges taken = space.journal().take_changes();
    CHECK(taken.changes.size() == 1'000);
    CHECK_FALSE(taken.is_complete);
    CHECK_FALSE(space.journal().has_changes());
    add_int32("child", nodes.back());
    taken = space.journal().take_changes();
    CHECK(taken.is_complete);
    CHECK(taken.changes.size() == 1);
}

TEST_CASE_METHOD(ChangeFixture, "What a removal takes along can be asked for")
{
    const NodeIndex below = add_folder("below", folder);
    const NodeIndex leaf = add_int32("leaf", below);
    REQUIRE(space.add_reference(below, NodeId{0, id::Organizes}, objects));
    std::vector<NodeIndex> seen;
    space.for_each_below(folder, [&](NodeIndex node) {
        seen.push_back(node);
        return true;
    });
    CHECK(seen == std::vector<NodeIndex>{folder, below, leaf});
    seen.clear();
    space.for_each_below(folder, [&](NodeIndex node) {
        seen.push_back(node);
        return false;
    });
    CHECK(seen == std::vector<NodeIndex>{folder});
}

} // namespace busbar::model::model_change_test
