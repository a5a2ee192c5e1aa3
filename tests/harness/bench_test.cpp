#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <type_traits>

#include <busbar/core/attribute_id.hpp>
#include <busbar/harness/catch.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/types/ids.hpp>

namespace bench_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;

namespace {

/// Two variables in a server, and a client that looks at them.
class LevelBench : public BenchFixture {
public:
    server::MemorySource& memory{make_source<server::MemorySource>(world().clock())};
    NodeId level{add_variable("Level", memory.variable(1.5)).value()};
    NodeId limit{add_variable("Limit", memory.variable(9.0)).value()};
};

/// Counts how often the server's code runs.
struct CountingWatch final : EngineWatch {
    void enter() override
    {
        ++depth;
        most = std::max(most, depth);
        ++count;
    }
    void leave() override { --depth; }

    int depth{0};
    int most{0};
    int count{0};
};

const NodeId server_object{0, id::Server};
const NodeId get_monitored_items{0, id::Server_GetMonitoredItems};

} // namespace

TEST_CASE_METHOD(LevelBench, "a bench reads, writes and calls", "[harness]")
{
    const auto values = read(std::vector{level, limit, NodeId{1, "Nothing"}});
    REQUIRE(values);
    REQUIRE(values->size() == 3);
    CHECK_THAT((*values)[0], holds(1.5));
    CHECK_THAT((*values)[1], holds(9.0));
    CHECK_THAT((*values)[2], has_status(status::Bad_NodeIdUnknown));
    CHECK(read(std::vector<NodeId>{}).error() == status::Bad_NothingToDo);
    CHECK_THAT(read(level, AttributeId::BrowseName), holds(QualifiedName{1, "Level"}));
    CHECK(write(level, Variant{"high"}) == status::Bad_TypeMismatch);
    CHECK(write(level, 2.5) == status::Good);
    CHECK_THAT(read(level), holds(2.5));
    const auto called = call(server_object, get_monitored_items, {Variant{std::uint32_t{7}}});
    REQUIRE(called);
    CHECK(called->status_code == status::Bad_SubscriptionIdInvalid);
    CHECK(call(server_object, level).value().status_code == status::Bad_MethodInvalid);
    CHECK(add_variable("Level", memory.variable(1.0)).error() == status::Bad_NodeIdExists);
}

TEST_CASE_METHOD(LevelBench, "a bench without a server says so with every verb", "[harness]")
{
    world().network().refuse();
    CHECK_THAT(read(level), has_status(status::Bad_ConnectionRejected));
    CHECK(write(level, 2.5) == status::Bad_ConnectionRejected);
    CHECK(call(server_object, get_monitored_items).error() == status::Bad_ConnectionRejected);
    CHECK(subscribe(level) == status::Bad_ConnectionRejected);
    CHECK_THROWS_AS(values(level), std::invalid_argument); // nobody watches it
    world().network().refuse(false);
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a bench gives the status of a service that fails", "[harness]")
{
    const auto fail_next = [&](const char* request) {
        world().network().play(fault::answer(status::Bad_OutOfMemory).at(Message{request}));
    };
    fail_next("ReadRequest");
    CHECK_THAT(read(level), has_status(status::Bad_OutOfMemory));
    fail_next("WriteRequest");
    CHECK(write(level, 2.5) == status::Bad_OutOfMemory);
    fail_next("CallRequest");
    CHECK(call(server_object, get_monitored_items).error() == status::Bad_OutOfMemory);
    fail_next("CreateSubscriptionRequest");
    CHECK(subscribe(level) == status::Bad_OutOfMemory);
    fail_next("CreateMonitoredItemsRequest");
    CHECK(subscribe(level) == status::Bad_OutOfMemory);
    CHECK(world().network().pending_faults() == "");
    CHECK_THAT(read(level), holds(1.5));
}

TEST_CASE_METHOD(LevelBench, "a bench watches values at the intervals that it can", "[harness]")
{
    CHECK(subscribe(level, 0ms) == status::Bad_InvalidArgument);
    CHECK(subscribe(level, -1s) == status::Bad_InvalidArgument);
    CHECK(subscribe(level, BenchOptions{}.client.request_timeout / 2) ==
          status::Bad_InvalidArgument);
    CHECK(subscribe(NodeId{1, "Nothing"}) == status::Bad_NodeIdUnknown);
    CHECK(subscribe(level) == status::Good);
    CHECK(subscribe(limit) == status::Good); // the same Subscription
    CHECK(subscribe(limit, 500ms) == status::Good);
    CHECK(server().subscription_count() == 2);
    run_for(1s);
    CHECK(write(level, 2.5) == status::Good);
    run_for(1s);
    const auto seen = values(level);
    REQUIRE(seen.size() == 2);
    CHECK_THAT(seen[0], holds(1.5));
    CHECK_THAT(seen[1], holds(2.5));
    CHECK(values(level).empty());
    // That of both Subscriptions.
    CHECK(values(limit).size() == 2);
    CHECK_THROWS_AS(values(NodeId{1, "Nothing"}), std::invalid_argument);
}

TEST_CASE_METHOD(LevelBench, "a bench tells of a lost Subscription and watches anew", "[harness]")
{
    REQUIRE(subscribe(level) == status::Good);
    run_for(1s);
    CHECK(values(level).size() == 1);
    world().network().cut();
    run_for(100s);
    const auto lost = values(level);
    REQUIRE(lost.size() == 1);
    CHECK_THAT(lost[0], has_status(status::Bad_ConnectionClosed));
    run_for(100s);
    CHECK(values(level).empty());

    CHECK(write(level, 2.5) == status::Good); // over a new connection
    run_for(1s);
    const auto found = values(level);
    REQUIRE(found.size() == 2);
    CHECK_THAT(found[0], holds(1.5)); // watched again before the write
    CHECK_THAT(found[1], holds(2.5));
}

TEST_CASE_METHOD(LevelBench, "a bench tells of a Subscription that the server ends", "[harness]")
{
    REQUIRE(subscribe(level) == status::Good);
    run_for(1s);
    CHECK(values(level).size() == 1);
    world().network().play(fault::answer(status::Bad_NoSubscription).at(Message{"PublishRequest"}));
    run_for(100s);
    const auto lost = values(level);
    REQUIRE_FALSE(lost.empty());
    CHECK_THAT(lost[0], has_status(status::Bad_NoSubscription));
    CHECK_THAT(read(level), holds(1.5));
    run_for(1s);
    const auto found = values(level);
    REQUIRE_FALSE(found.empty());
    CHECK_THAT(found.back(), holds(1.5));

    // The server itself has not ended the first Subscription, whose notifications do not count.
    CHECK(write(level, 2.5) == status::Good);
    run_for(1s);
    const auto written = values(level);
    REQUIRE(written.size() == 1);
    CHECK_THAT(written[0], holds(2.5));
}

TEST_CASE("a bench whose server cannot be made says why", "[harness]")
{
    BenchOptions options;
    options.server.endpoints = server::secure_endpoints();
    CHECK_THROWS_WITH(Bench{options},
                      Catch::Contains("there is no server") && Catch::Contains("certificate"));
}

TEST_CASE("a bench logs users in over each kind of channel, with their roles", "[harness]")
{
    BenchOptions options;
    options.server = secured_server_config();
    BenchFixture bench{options};
    bench.users().everybody.access_level_mask = 1; // CurrentRead
    bench.users().add("maria", "secret", {0xFF, {"Operator"}});
    const NodeId level = need(bench.add_variable("Level", 1.5));
    model::NodeAccess access;
    access.restrictions = 2; // EncryptionRequired
    access.role_permissions = {{NodeId{0, id::WellKnownRole_Operator},
                                PermissionType{static_cast<std::uint32_t>(PermissionType::Browse) |
                                               static_cast<std::uint32_t>(PermissionType::Read)}}};
    model::AddressSpace& space = bench.server().address_space();
    space.set_node_access(space.find(level), access);
    const client::NamedUser maria{"maria", "secret"};
    const auto* const policy = crypto::find_policy_by_name("Basic256Sha256");

    BenchClient& encrypted = bench.log_in(maria, {policy, MessageSecurityMode::SignAndEncrypt});
    CHECK_THAT(encrypted.read(level), holds(1.5));
    BenchClient& is_signed = bench.log_in(maria, {policy, MessageSecurityMode::Sign});
    CHECK_THAT(is_signed.read(level), has_status(status::Bad_SecurityModeInsufficient));
    CHECK(&encrypted == &bench.client("maria"));
    CHECK(&is_signed == &bench.client("maria 2"));
    BenchClient& anybody = bench.log_in({}, {policy, MessageSecurityMode::SignAndEncrypt});
    CHECK_THAT(anybody.read(level), has_status(status::Bad_NodeIdUnknown));
    CHECK(&anybody == &bench.client("anonymous"));
    CHECK(bench.server().session_count() == 3);
    CHECK_THROWS_WITH(bench.log_in(client::NamedUser{"maria", "wrong"}),
                      Catch::Contains("Bad_UserAccessDenied"));
}

TEST_CASE("a server host logs where a test wants it to, and maps roles", "[harness]")
{
    /// Gives everybody one more role.
    struct AllObserve final : server::RoleMapper {
        [[nodiscard]] server::UserRights roles_of(const server::RoleQuestion&) const override
        {
            return {0, {"Observer"}};
        }
    } const mapper;
    LogBook log;
    BenchOptions options;
    options.server_parts.log = &log;
    options.server_parts.roles = &mapper;
    BenchFixture bench{options};
    const NodeId level = need(bench.add_variable("Level", 1.5));
    model::NodeAccess access;
    access.role_permissions = {{NodeId{0, id::WellKnownRole_Observer}, PermissionType{33}}};
    model::AddressSpace& space = bench.server().address_space();
    space.set_node_access(space.find(level), access);
    CHECK_THAT(bench.read(level), holds(1.5));
    CHECK(log.contains("activated by"));
    CHECK_FALSE(bench.world().log().contains("activated by"));
}

TEST_CASE("an identity is made once", "[harness]")
{
    const channel::ApplicationIdentity& server = default_server_identity();
    CHECK(&server == &default_server_identity());
    CHECK(server.certificates.front().application_uri() == "urn:busbar:harness:server");
    CHECK_FALSE(server.certificates.front() == default_client_identity().certificates.front());
}

TEST_CASE("an ExtensionObject is made of a structure", "[harness]")
{
    Range range{1, 2};
    const ExtensionObject made{range};
    CHECK(made == ExtensionObject::from(range));
    CHECK(made.get_if<Range>()->high == 2);
    CHECK(ExtensionObject{range, 3} == ExtensionObject::from(range, 3));
    STATIC_REQUIRE_FALSE(std::is_convertible_v<Range, ExtensionObject>); // not by mistake
    STATIC_REQUIRE_FALSE(std::is_constructible_v<ExtensionObject, int>);
}

TEST_CASE("a server host says why it has no server", "[harness]")
{
    World world;
    server::ServerConfig config = open_server_config();
    config.endpoint_url = "no URL";
    ServerHost host{world, config};
    CHECK_FALSE(host.is_running());
    REQUIRE(host.problem());
    CHECK(host.problem()->where == "endpoint_url");
    CHECK(ConnectionHost{world}.open().error() == status::Bad_ConnectionRejected);
    const ServerHost sound{world};
    CHECK_FALSE(sound.problem());
    CHECK(ConnectionHost{world}.open().has_value());
}

TEST_CASE("a server host takes as many connections as its server", "[harness]")
{
    World world;
    server::ServerConfig config = open_server_config();
    config.limits.max_connections = 1;
    config.limits.max_connections_per_address = 1;
    ServerHost host{world, config};
    ConnectionHost first{world};
    REQUIRE(first.open());
    ConnectionHost second{world};
    CHECK_FALSE(second.open());
    CHECK(first.is_ready());
    CHECK(host.server().connection_count() == 1);
}

TEST_CASE("a watch knows when the server's own code runs", "[harness]")
{
    CountingWatch watch;
    BenchOptions options;
    options.server_parts.watch = &watch;
    {
        BenchFixture bench{options};
        REQUIRE(bench.connect());
        const int before = watch.count;
        CHECK(watch.depth == 0);
        CHECK(bench.read(server_object).status == status::Bad_AttributeIdInvalid);
        CHECK(watch.count > before);
    }
    CHECK(watch.depth == 0);
    CHECK(watch.most == 1);
}

TEST_CASE("completions wake a server late, if they are to", "[harness]")
{
    BenchOptions options;
    options.server_parts.wake_delay = 10ms;
    options.server_parts.rare_wake_delay = 2s;
    BenchFixture bench{options};
    auto& memory = bench.make_source<server::MemorySource>(bench.world().clock());
    const NodeId level = bench.add_variable("Level", memory.variable(1)).value();
    REQUIRE(bench.subscribe(level, 50ms) == status::Good);
    for (int i = 2; i < 20; ++i) {
        CHECK(bench.write(level, i) == status::Good);
        bench.run_for(3s);
    }
    const auto seen = bench.values(level);
    REQUIRE(seen.size() == 19);
    for (std::size_t i = 0; i < seen.size(); ++i) {
        CHECK_THAT(seen[i], holds(static_cast<std::int32_t>(i + 1)));
    }
}

TEST_CASE("the environment gives the seed", "[harness]")
{
    const char* const known = std::getenv("BUSBAR_SEED");
    const std::string before = known == nullptr ? "" : known;
    ::setenv("BUSBAR_SEED", "77", 1);
    CHECK(World::seed_from_environment() == 77);
    CHECK(World{}.seed() == 77);
    ::setenv("BUSBAR_SEED", "x", 1);
    CHECK(World::seed_from_environment() == 1);
    ::unsetenv("BUSBAR_SEED");
    CHECK(World::seed_from_environment() == 1);
    if (known != nullptr) {
        ::setenv("BUSBAR_SEED", before.c_str(), 1);
    }
}

TEST_CASE("matchers say what they want", "[harness]")
{
    CHECK(holds(7).describe() == "holds Int32 7");
    CHECK(holds(String{"a"}).describe() == "holds String \"a\"");
    CHECK_FALSE(holds(7).match(DataValue{Variant{8}}));
    CHECK_FALSE(holds(7).match(DataValue{Variant{7}, status::Uncertain}));
    CHECK(has_status(status::Bad_Timeout).describe() == "has Bad_Timeout");
    CHECK(has_status(status::Bad_Timeout).match(DataValue{StatusCode{0x800A0401}}));
    CHECK_FALSE(has_status(status::Bad_Timeout).match(DataValue{Variant{7}}));
    CHECK(succeeds<int>().describe() == "is a value");
    CHECK(succeeds<int>().match(Result<int>{7}));
    CHECK_FALSE(succeeds<int>().match(fail(status::Bad_Timeout)));
    using Catch::Detail::stringify;
    CHECK(stringify(StatusCode{status::Bad_Timeout}) == "Bad_Timeout");
    CHECK(stringify(Variant{7}) == "Int32 7");
    CHECK(stringify(DataValue{Variant{7}}) == "Int32 7");
    CHECK(stringify(Result<int>{7}) == "7");
    CHECK(stringify(Result<int>{fail(status::Bad_Timeout)}) == "Bad_Timeout");
    CHECK(stringify(Result<void>{}) == "a value");
}

} // namespace bench_test
