#include <utility>
#include <vector>

#include "failure_cases.hpp"
#include "support/failing_worlds.hpp"

namespace timer_allocation_failure_test {

/// Timed work of a server with the k-th of its allocations failing, for k = 1, 2, ... until nothing
/// fails. Others are served meanwhile, and the work is done soon after.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

struct Row {
    const char* name;
    void (*prepare)(FailureFixture&);
    /// What the server does of which something fails, and then `time`.
    void (*act)(FailureFixture&);
    Duration time;
    Duration step;
    void (*check)(FailureFixture&);
};

void do_nothing(FailureFixture&) {}

void watch_values(FailureFixture& world)
{
    world.monitor(world.subscribe());
}

void watch_events(FailureFixture& world)
{
    REQUIRE(
        world.client.call<CreateMonitoredItemsResponse>(failing::event_item(world.subscribe())));
}

void raise(FailureFixture& world)
{
    server::Event event;
    event.message = LocalizedText{"a message that does not fit into a small string"};
    event.severity = 500;
    event.source_node = NodeId{0, id::Server};
    world.counted([&] { world.server.raise_event(std::move(event)); });
}

/// Whether a Publish request brings something now.
StatusCode publish(FailureFixture& world)
{
    StatusCode answer = status::Bad_NoData;
    for (int i = 0; i < 10 && answer == status::Bad_NoData; ++i) {
        answer = world.ask(world.client, failing::publish_something());
    }
    return answer;
}

std::size_t count_events(FailureFixture& world)
{
    std::size_t count = 0;
    for (int i = 0; i < 10; ++i) {
        const auto sent = world.client.send(PublishRequest{});
        for (int cycle = 0; cycle < 5; ++cycle) {
            world.pass(100ms, world.client);
        }
        const auto response = world.client.take<PublishResponse>(sent);
        REQUIRE(response);
        for (const ExtensionObject& part : response->notification_message.notification_data) {
            if (const auto* const list = part.get_if<EventNotificationList>()) {
                count += list->events.size();
            }
        }
    }
    return count;
}

void check_nothing_left(FailureFixture& world)
{
    CHECK(world.server.subscription_count() == 0);
    CHECK(world.server.monitored_item_count() == 0);
}

constexpr Row rows[] = {
    {"a session that times out", watch_values, do_nothing, 70s, 1s,
     [](FailureFixture& world) {
         CHECK(world.server.session_count() == 1);
         check_nothing_left(world);
     }},
    {"a session that nobody activates",
     [](FailureFixture& world) { REQUIRE(world.client.create_session()); }, do_nothing, 70s, 1s,
     [](FailureFixture& world) {
         // The other one of the client, which has timed out as well.
         CHECK(world.server.session_count() == 1);
     }},
    {"a Subscription that nobody asks for", watch_values, do_nothing, 5s, 100ms,
     [](FailureFixture& world) {
         check_nothing_left(world);
         CHECK(world.server.session_count() == 2);
     }},
    {"values while requests wait",
     [](FailureFixture& world) {
         watch_values(world);
         for (int i = 0; i < 3; ++i) {
             world.client.send(PublishRequest{});
         }
     },
     do_nothing, 2s, 100ms,
     [](FailureFixture& world) {
         CHECK(world.ask(world.client, failing::write(world)) == status::Good);
         CHECK(publish(world) == status::Good);
     }},
    {"values that nobody asks for", watch_values,
     [](FailureFixture& world) {
         static_cast<void>(world.ask(world.client, failing::write(world)));
     },
     1s, 100ms, [](FailureFixture& world) { CHECK(publish(world) == status::Good); }},
    {"events", watch_events,
     [](FailureFixture& world) {
         raise(world);
         raise(world);
     },
     500ms, 100ms,
     [](FailureFixture& world) {
         // Each or, in place of those that are lost, one that says so.
         CHECK(count_events(world) == 2);
     }},
};

/// False if nothing failed.
bool fail_once(const Row& row, std::size_t k)
{
    FailureFixture world;
    row.prepare(world);
    fail_allocation(k);
    row.act(world);
    for (Duration passed{}; passed < row.time; passed += row.step) {
        world.pass(row.step, world.client);
        CHECK(use(world.other) == status::Good);
    }
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.name << ", allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    world.pass(row.step, world.client);
    if (world.client.is_closed()) {
        CHECK((has_failed || row.time > 30s)); // after which it is closed without a session
        world.client = world.again(world.client);
    }
    row.check(world);
    CHECK(world.server.next_deadline() > world.now);
    return has_failed;
}

/// All sessions time out when there is no memory at all.
void end_without_memory(FailureFixture& world)
{
    world.now += 70s;
    fail_allocation(1, 1'000'000);
    world.counted([&] { world.server.handle_deadline(world.now); });
    fail_allocation(0);
    CHECK(world.thrown == 0);
}

/// False if a worker's answers to two logins, which come at the same time, were taken without a
/// failure.
bool fail_two_logins(std::size_t k)
{
    FailureFixture world;
    world.users.used_worker = &world.worker;
    std::vector<std::pair<TestClient, std::uint32_t>> logins;
    for (int i = 0; i < 2; ++i) {
        TestClient client = world.connect("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);
        REQUIRE(client.create_session());
        const auto sent = client.send_activate(client.user("operator", "operator-secret"));
        logins.emplace_back(std::move(client), sent);
    }
    REQUIRE(world.worker.jobs.size() == 2);
    fail_allocation(k);
    world.pass(100ms, logins[0].first);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    int refused = 0;
    for (auto& [client, sent] : logins) {
        world.pass(100ms, client);
        const StatusCode answer = client.take_activate(sent);
        refused += answer == status::Good ? 0 : 1;
        CHECK((answer == status::Good || answer == status::Bad_OutOfMemory || client.is_closed()));
    }
    CHECK(refused <= (has_failed ? 1 : 0)); // the other one has its answer
    CHECK(use(world.other) == status::Good);
    return has_failed;
}

} // namespace

TEST_CASE("of logins that a worker has checked one alone ends where there is no memory")
{
    check_failing_worlds("two logins", fail_two_logins);
}

TEST_CASE("an allocation that fails keeps a server from nothing that it does in time")
{
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.name)
        {
            check_failing_worlds(row.name, [&](std::size_t k) { return fail_once(row, k); });
        }
    }
}

TEST_CASE("what finds no memory when it is due is tried again, but not at once")
{
    FailureFixture world;
    watch_values(world);
    end_without_memory(world);
    CHECK(world.server.next_deadline() > world.now);
    CHECK(world.server.next_deadline() <= world.now + 1s);
    world.pass(1s, world.client);
    CHECK(world.server.session_count() == 0);
}

TEST_CASE("that events were lost is told when there is memory again")
{
    FailureFixture world;
    watch_events(world);
    fail_allocation(1, 1'000'000);
    raise(world);
    world.pass(100ms, world.client);
    REQUIRE(has_allocation_failed());
    fail_allocation(0);
    CHECK(count_events(world) == 1);
}

TEST_CASE("a session without Subscriptions ends without memory")
{
    FailureFixture world;
    end_without_memory(world);
    CHECK(world.server.session_count() == 0);
}

} // namespace timer_allocation_failure_test
