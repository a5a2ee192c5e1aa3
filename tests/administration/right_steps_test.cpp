#include <array>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/types/configuration.hpp>

#include "administration/node_table.hpp"
#include "right_matrix.hpp"

namespace right_steps_test {

// Each Object of the administration that is read or written in steps: every file, transfer and
// trust list. Whoever has the right for the first step and loses it, or hands the session on to
// another user, comes no further, and nothing of it has an effect.

using namespace right_matrix;

namespace {

/// An Object with the Methods Open, Read and Write, or one that makes such Objects.
struct Stepped {
    std::string path;
    NodeId object;
    Thing reading;
    Thing writing;
    bool is_transfer{false};
    bool is_trust_list{false};
};

/// How the right is lost.
enum class Loss : std::uint8_t { RoleTaken, NextUser };
constexpr std::array losses{Loss::RoleTaken, Loss::NextUser};

struct Steps : Taken {
    explicit Steps(const Identity& of) : Taken{of}
    {
        REQUIRE(file_storage.make_folder("d", FileAccess::Owner));
        for (const char* file : {"a", "b", "d/c"}) {
            REQUIRE(file_storage.replace(file, std::as_bytes(std::span{"first", 5}),
                                         FileAccess::Owner));
        }
        REQUIRE(user_certificates.add(crypto::StoreList::Trusted,
                                      client_identity().certificates.front().der()));
        transfers.made.assign(10, std::byte{7});
        administration->refresh_files();
        complete();
        before = contents();
    }
    /// All files of the server, except the roles, which the tests themselves change.
    [[nodiscard]] std::map<std::string, std::vector<std::byte>> contents()
    {
        std::map<std::string, std::vector<std::byte>> all;
        for (const std::string& file : storage.names()) {
            if (file != "roles.json") {
                all[file] = read_file(storage, file, 1U << 20U).value();
            }
        }
        return all;
    }
    [[nodiscard]] NodeId method(const NodeId& object, const char* called)
    {
        const auto& space = server.address_space();
        const model::NodeIndex found = child_of(space, space.find(object), called);
        INFO(called << " of " << to_string(object));
        REQUIRE(found != model::no_node);
        return space.node_id(found);
    }
    CallMethodResult on(const NodeId& object, const char* called, std::vector<Variant> inputs)
    {
        return call(*pat, object, method(object, called), std::move(inputs));
    }
    /// The Object to read or to write, and the handle.
    std::pair<NodeId, Variant> open(const Stepped& each, bool writes)
    {
        if (!each.is_transfer) {
            const auto result = on(each.object, "Open", {Variant{writes ? writing : reading}});
            REQUIRE(name(result.status_code) == "Good");
            return {each.object, result.output_arguments[0]};
        }
        const auto result =
            on(each.object, writes ? "GenerateFileForWrite" : "GenerateFileForRead", {Variant{}});
        REQUIRE(name(result.status_code) == "Good");
        return {*result.output_arguments[0].get_if<NodeId>(), result.output_arguments[1]};
    }
    StatusCode write(const std::pair<NodeId, Variant>& opened, const Stepped& each)
    {
        // A list without certificates, which would be taken.
        TrustListDataType list;
        list.specified_lists = 1;
        binary::VectorSink sink;
        binary::Writer writer{sink};
        encode(writer, list);
        const auto bytes = each.is_trust_list ? sink.take(writer.written())
                                              : std::vector<std::byte>(4, std::byte{1});
        return on(opened.first, "Write", {opened.second, Variant{ByteString{bytes}}}).status_code;
    }
    StatusCode end(const std::pair<NodeId, Variant>& opened, const Stepped& each)
    {
        return on(each.object,
                  each.is_transfer     ? "CloseAndCommit"
                  : each.is_trust_list ? "CloseAndUpdate"
                                       : "Close",
                  {opened.second})
            .status_code;
    }
    void lose(Loss loss)
    {
        if (loss == Loss::RoleTaken) {
            return take();
        }
        REQUIRE(pat->activate(pat->user("userObserver", "x")) == status::Good);
    }
    /// Neither now, nor when the session has gone.
    void check_unchanged()
    {
        CHECK(contents() == before);
        CHECK(pat->close_session() == status::Good);
        complete();
        advance(std::chrono::seconds{30}); // after which temporary files go
        complete();
        CHECK(contents() == before);
        CHECK(transfers.taken.empty());
        CHECK(count(applications, crypto::StoreList::Trusted) == 1);
    }

    std::map<std::string, std::vector<std::byte>> before;
};

/// All of them, found by their Methods.
std::vector<Stepped> stepped()
{
    Steps world{identities.back()};
    const auto& space = world.server.address_space();
    std::vector<Stepped> all;
    const std::function<void(model::NodeIndex, const std::string&)> look =
        [&](model::NodeIndex node, const std::string& path) {
            const auto thing = [&](const char* called) { return thing_at(path + called); };
            const NodeId borrowed = space.node_id(node); // copies outlive the server
            const bool is_transfer = child_of(space, node, "CloseAndCommit") != model::no_node;
            const bool is_list = child_of(space, node, "CloseAndUpdate") != model::no_node;
            if (is_transfer) {
                all.push_back({path, borrowed, Thing::Files, thing("/GenerateFileForWrite"), true});
            } else if (is_list) {
                all.push_back({path, borrowed, thing("/Read"), thing("/Write"), false, true});
            } else if (child_of(space, node, "Write") != model::no_node) {
                all.push_back({path, borrowed, Thing::Files, Thing::FileChanges});
            }
            model::ReferenceCursor cursor = space.references(node);
            while (const auto reference = cursor.next()) {
                if (reference->is_forward &&
                    space.is_subtype_of(reference->type, id::HierarchicalReferences) &&
                    space.node_class(reference->target) == NodeClass::Object) {
                    look(reference->target,
                         path + "/" + space.browse_name(reference->target).name.str());
                }
            }
        };
    for (const NodeId& root : {NodeId{0, id::ServerConfiguration}, NodeId{1, "Files/recipes"},
                               NodeId{1, "Transfers/backup"}}) {
        const model::NodeIndex node = space.find(root);
        look(node, space.browse_name(node).name.str());
    }
    return all;
}

/// Calls `act` with a world for each Object, each identity whose role has the right, and each way
/// to lose it. Returns how often.
std::size_t for_each(Roles (*right)(const Stepped&),
                     const std::function<void(Steps&, const Stepped&, Loss)>& act)
{
    std::size_t tried = 0;
    const std::vector<Stepped> all = stepped();
    CHECK(all.size() == 6); // two trust lists, three files and a transfer
    for (const Stepped& each : all) {
        for (const Identity& identity : identities) {
            const Roles some = right(each);
            if ((some & identity.roles) == 0 || (some & who::everybody) != 0) {
                continue;
            }
            for (const Loss loss : losses) {
                INFO(each.path << ", " << identity.role
                               << (loss == Loss::RoleTaken ? ", role taken" : ", next user"));
                Steps world{identity};
                act(world, each, loss);
                ++tried;
            }
        }
    }
    return tried;
}

Roles may_read(const Stepped& each)
{
    return right_of(each.reading).standard.call;
}

Roles may_write(const Stepped& each)
{
    return right_of(each.writing).standard.call;
}

} // namespace

TEST_CASE("right steps: what was opened is not read without the right", "[attack]")
{
    const auto tried = for_each(may_read, [](Steps& world, const Stepped& each, Loss loss) {
        const auto opened = world.open(each, false);
        const std::vector<Variant> inputs{opened.second, Variant{std::int32_t{100}}};
        CHECK(name(world.on(opened.first, "Read", inputs).status_code) == "Good");
        world.lose(loss);
        const auto read = world.on(opened.first, "Read", inputs);
        CHECK(read.status_code.is_bad());
        CHECK(read.output_arguments.empty());
        world.check_unchanged();
    });
    CHECK(tried >= 12);
}

TEST_CASE("right steps: what was opened is not written, nor ended, without the right", "[attack]")
{
    const auto tried = for_each(may_write, [](Steps& world, const Stepped& each, Loss loss) {
        const auto opened = world.open(each, true);
        world.lose(loss);
        CHECK(world.write(opened, each).is_bad());
        static_cast<void>(world.end(opened, each)); // a file without a change may be closed
        world.check_unchanged();
    });
    CHECK(tried >= 12);
}

TEST_CASE("right steps: what was written has no effect without the right", "[attack]")
{
    const auto tried = for_each(may_write, [](Steps& world, const Stepped& each, Loss loss) {
        const auto opened = world.open(each, true);
        CHECK(name(world.write(opened, each)) == "Good");
        world.lose(loss);
        CHECK(world.end(opened, each).is_bad());
        world.check_unchanged();
    });
    CHECK(tried >= 12);
}

TEST_CASE("right steps: a transaction that was begun is not applied without the right", "[attack]")
{
    std::size_t lists = 0;
    static_cast<void>(for_each(may_write, [&](Steps& world, const Stepped& each, Loss loss) {
        if (!each.is_trust_list) {
            return;
        }
        const auto opened = world.open(each, true);
        CHECK(name(world.write(opened, each)) == "Good");
        CHECK(name(world.end(opened, each)) == "Good");
        world.lose(loss);
        CHECK(
            world.on(NodeId{0, id::ServerConfiguration}, "ApplyChanges", {}).status_code.is_bad());
        world.check_unchanged();
        ++lists;
    }));
    CHECK(lists == 4);
}

TEST_CASE("right steps: with the right each of them has its effect", "[attack]")
{
    for (const Stepped& each : stepped()) {
        for (const Identity& identity : identities) {
            if ((may_write(each) & identity.roles) == 0) {
                continue;
            }
            INFO(each.path << ", " << identity.role);
            Steps world{identity};
            const auto opened = world.open(each, true);
            CHECK(name(world.write(opened, each)) == "Good");
            CHECK(name(world.end(opened, each)) == "Good");
            if (each.is_trust_list) {
                const auto applied =
                    world.on(NodeId{0, id::ServerConfiguration}, "ApplyChanges", {});
                CHECK_FALSE(applied.status_code.is_bad());
            }
            world.complete();
            CHECK((world.contents() != world.before || !world.transfers.taken.empty()));
        }
    }
}

} // namespace right_steps_test
