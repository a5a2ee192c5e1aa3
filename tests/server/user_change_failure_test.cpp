#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "failure_cases.hpp"
#include "server/rights/node_rights.hpp"
#include "support/failing_worlds.hpp"

namespace user_change_failure_test {

/// Sends logins and changes of users while there is no memory.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

/// Items of two Variables that only one role may read, in two Subscriptions.
struct GuardedWorld : FailureFixture {
    GuardedWorld()
    {
        model::AddressSpace& space = server.address_space();
        for (const char* const name : {"level", "speed"}) {
            model::NodeAccess access;
            RolePermissionType permission;
            permission.role_id = NodeId{0, id::WellKnownRole_ConfigureAdmin};
            permission.permissions = PermissionType{server::detail::all_permissions};
            access.role_permissions.push_back(permission);
            space.set_node_access(space.find(own(name)), access);
        }
        monitor(subscribe());
        monitor(subscribe());
        pass(100ms, client);
    }
    /// Another client writes both.
    void write(std::int32_t written)
    {
        WriteRequest request;
        request.nodes_to_write.resize(2);
        request.nodes_to_write[0].node_id = own("level");
        request.nodes_to_write[1].node_id = own("speed");
        for (WriteValue& value : request.nodes_to_write) {
            value.attribute_id = 13;
            value.value.value = written;
        }
        REQUIRE(ask(other, asking<WriteResponse>(request)) == status::Good);
    }
    /// How often a value is reported that another writes now, or that was `queued` before.
    [[nodiscard]] int leaks(std::int32_t written)
    {
        write(written);
        int found = 0;
        for (const MonitoredItemNotification& one : reported()) {
            found += one.value.value == Variant{written} || one.value.value == Variant{queued};
        }
        return found;
    }

    static constexpr std::int32_t queued = 9;
};

bool fail_once(std::size_t k, std::size_t most)
{
    GuardedWorld world;
    world.write(GuardedWorld::queued);
    world.pass(100ms, world.client);
    world.users.everybody.roles.clear();
    ActivateSessionRequest request;
    request.user_identity_token = TestClient::anonymous();
    const FailureCase asked = asking<ActivateSessionResponse>(request);
    auto [answer, has_failed] = world.attempt(asked, k, most);
    INFO("allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    // Until it is asked again it is one user's or the other's.
    if (world.ask(world.client, failing::read(world)) != status::Good) {
        CHECK(world.leaks(8) == 0);
    }
    if (answer != status::Good) {
        answer = world.ask(world.client, asked);
        CHECK(answer == status::Good);
    }
    CHECK(world.leaks(7) == 0);
    return has_failed;
}

bool fail_expiry(std::size_t k, std::size_t most)
{
    GuardedWorld world;
    world.users.everybody.valid_until = {world.wall_clock.time.ticks + DateTime::ticks_per_second};
    ActivateSessionRequest request;
    request.user_identity_token = TestClient::anonymous();
    REQUIRE(world.ask(world.client, asking<ActivateSessionResponse>(request)) == status::Good);
    world.users.everybody.roles.clear();
    world.users.everybody.valid_until = {};
    fail_allocation(k, most);
    world.pass(1100ms, world.client);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK(world.leaks(7) == 0);
    return has_failed;
}

/// Fills a worker with logins, of which one client has the most, before another one comes.
struct FullWorker {
    FullWorker()
    {
        worker.most = 4;
        fixture.users.used_worker = &worker;
        for (int i = 0; i < 3; ++i) {
            clients.push_back(
                fixture.connect({}, client_identity(), "192.0.2." + std::to_string(i)));
            REQUIRE(clients.back().create_session());
        }
        for (const int i : {0, 0, 0, 1}) {
            sent.emplace_back(i, log_in(clients[static_cast<std::size_t>(i)]));
        }
    }
    std::uint32_t log_in(TestClient& client)
    {
        const std::string name = "user" + std::to_string(sent.size());
        return client.send_activate(client.user(name, name + "-secret"));
    }
    /// Counts attempts that wait for the worker, over connections that have survived; forgets those
    /// that have their answer.
    [[nodiscard]] int waiting()
    {
        std::erase_if(sent, [&](const auto& attempt) {
            TestClient& client = clients[static_cast<std::size_t>(attempt.first)];
            return client.take_activate(attempt.second) != status::Bad_WouldBlock ||
                   client.is_closed();
        });
        return static_cast<int>(sent.size());
    }

    SilentWaker waker;
    JobList worker;
    ServerFixture fixture{waker};
    std::deque<TestClient> clients;
    std::vector<std::pair<int, std::uint32_t>> sent;
};

bool fail_displacing(std::size_t k, std::size_t most)
{
    FullWorker world;
    TestClient& late = world.clients[2];
    ActivateSessionRequest request;
    request.client_signature = late.signature();
    request.user_identity_token = late.user("late", "late-secret");
    const FailureCase asked = asking<ActivateSessionResponse>(request);
    const std::uint32_t id = asked.send(late);
    world.sent.emplace_back(2, id);
    const auto bytes = take_output(late.channel);
    fail_allocation(k, most);
    const bool has_survived = survives_counted(
        [&] { static_cast<void>(late.connection.feed(bytes, world.fixture.now)); });
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    CHECK(has_survived);
    for (TestClient& client : world.clients) {
        client.run();
    }
    const int waiting = world.waiting();
    INFO("allocation " << k << "\n" << world.fixture.log.text);
    CHECK(waiting >= 3);
    while (world.worker.work_once()) {
    }
    CHECK(world.fixture.users.asked == waiting); // and none whose client has its answer
    world.fixture.server.handle_completions(world.fixture.now);
    for (TestClient& client : world.clients) {
        client.run();
    }
    CHECK(world.waiting() == 0);
    return has_failed;
}

} // namespace

TEST_CASE("who a session was given to in the end reads by that user's rights only")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("ActivateSession", [&](std::size_t k) { return fail_once(k, most); });
}

TEST_CASE("nothing is read any more by the rights of a user whose time is over")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("the end of a user", [&](std::size_t k) { return fail_expiry(k, most); });
}

TEST_CASE("a login that takes another one's place at the worker ends, or waits, for lack of memory")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("a login at a full worker",
                         [&](std::size_t k) { return fail_displacing(k, most); });
}

} // namespace user_change_failure_test
