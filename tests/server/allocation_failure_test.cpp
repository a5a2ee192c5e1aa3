#include "failure_cases.hpp"
#include "support/failing_worlds.hpp"

namespace allocation_failure_test {

/// Each service with the k-th of its allocations failing, for k = 1, 2, ... until it goes
/// through. Whatever fails ends the request with Bad_OutOfMemory, or its connection, and leaves
/// nothing behind: another session is served at once, and the same request succeeds.
using namespace busbar;
using namespace busbar::test;

namespace {

struct Row {
    const char* service;
    FailureCase (*prepare)(FailureFixture&);
};

constexpr Row rows[] = {
    {"FindServers", failing::find_servers},
    {"GetEndpoints", failing::get_endpoints},
    {"CreateSession", failing::create_session},
    {"ActivateSession", failing::activate_session},
    {"ActivateSession with a worker", failing::log_in_by_worker},
    {"CloseSession", failing::close_session},
    {"Cancel", failing::cancel},
    {"Read", failing::read},
    {"Write", failing::write},
    {"Browse", failing::browse},
    {"Browse in parts", failing::browse_in_part},
    {"BrowseNext", failing::browse_next},
    {"TranslateBrowsePathsToNodeIds", failing::translate_browse_paths},
    {"RegisterNodes", failing::register_nodes},
    {"UnregisterNodes", failing::unregister_nodes},
    {"Call", failing::call},
    {"CreateSubscription", failing::create_subscription},
    {"ModifySubscription", failing::modify_subscription},
    {"SetPublishingMode", failing::set_publishing_mode},
    {"DeleteSubscriptions", failing::delete_subscriptions},
    {"TransferSubscriptions", failing::transfer_subscriptions},
    {"CreateMonitoredItems", failing::create_items},
    {"CreateMonitoredItems of events", failing::create_event_item},
    {"ModifyMonitoredItems", failing::modify_items},
    {"SetMonitoringMode", failing::set_monitoring_mode},
    {"SetTriggering", failing::set_triggering},
    {"DeleteMonitoredItems", failing::delete_items},
    {"Publish of data", failing::publish_data},
    {"Publish of events", failing::publish_events},
    {"Republish", failing::republish},
    {"AddNodes", failing::add_nodes},
    {"DeleteNodes", failing::delete_nodes},
    {"AddReferences", failing::add_references},
    {"DeleteReferences", failing::delete_references},
};

/// Each of the first 300, and every seventh after them: most requests have less than 100 in all,
/// and what has more makes nodes, each like the one before. All cases take 7 s of processor time
/// so, with the address sanitizer and -O1 as well.
std::size_t next(std::size_t k)
{
    return k < 300 ? k + 1 : k + 7;
}

/// What has to hold when something failed and `answer` came of it.
void check_after(FailureFixture& world, const FailureCase& asked, StatusCode answer,
                 const std::vector<std::size_t>& before)
{
    CHECK(use(world.other) == status::Good);
    if (answer == status::Good || answer == status::Bad_NoData) {
        return;
    }
    CHECK((answer == status::Bad_OutOfMemory || world.client.is_closed()));
    if (world.client.is_closed()) {
        if (asked.dies_with_connection) {
            return;
        }
        world.client = world.again(world.client);
    }
    CHECK(world.counts() == before);
    StatusCode second = status::Bad_NoData;
    for (int i = 0; i < 3 && second == status::Bad_NoData; ++i) {
        second = world.ask(world.client, asked);
    }
    CHECK(second == status::Good);
}

/// False if the request went through without a failure.
bool fail_once(const Row& row, std::size_t k)
{
    FailureFixture world;
    const FailureCase asked = row.prepare(world);
    const auto before = world.counts();
    fail_allocation(k);
    const StatusCode answer = world.ask(world.client, asked);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.service << ", allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    if (has_failed) {
        check_after(world, asked, answer, before);
        world.advance(std::chrono::seconds{1});
        CHECK(world.server.next_deadline() > world.now);
    } else {
        CHECK(answer == status::Good);
    }
    return has_failed;
}

/// The same when there is no memory for a while: the server cannot undo all that it has begun, but
/// it lives, and serves the others.
bool fail_for_a_while(const Row& row, std::size_t k)
{
    FailureFixture world;
    const FailureCase asked = row.prepare(world);
    fail_allocation(k, 12);
    const StatusCode answer = world.ask(world.client, asked);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.service << ", allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK(answer != status::Bad_WouldBlock);
    CHECK(use(world.other) == status::Good);
    world.advance(std::chrono::seconds{1});
    CHECK(world.server.next_deadline() > world.now);
    return has_failed;
}

const channel::SecuritySetting secure =
    setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

/// False if the channel was opened without a failure.
bool fail_opening(const channel::SecuritySetting& security, bool has_worker, std::size_t k)
{
    FailureFixture world{has_worker};
    const auto before = world.counts();
    fail_allocation(k);
    auto opened = world.open(security);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK(use(world.other) == status::Good);
    const bool is_open = opened != nullptr && opened->channel.is_open();
    CHECK((is_open || (has_failed && (opened == nullptr || opened->is_closed()))));
    opened.reset();
    CHECK(world.server.connection_count() == 2);
    CHECK(world.counts() == before);
    CHECK(world.channel_worker.jobs.empty());
    const auto second = world.open(security);
    CHECK((second != nullptr && second->channel.is_open()));
    return has_failed;
}

/// False if the server said ReverseHello without a failure.
bool fail_reverse_hello(std::size_t k)
{
    FailureFixture world;
    const auto say = [&] {
        std::optional<server::Connection> connection;
        Result<void> said = fail(status::Bad_OutOfMemory);
        world.counted([&] {
            if (auto made = world.server.connect("192.0.2.1", world.now)) {
                connection.emplace(*std::move(made));
                said = connection->reverse_hello("opc.tcp://plc.example:4840");
            }
        });
        const bool has_said = said && !connection->output().empty();
        CHECK((has_said || !connection || !said || connection->is_closed()));
        return has_said;
    };
    fail_allocation(k);
    const bool has_said = say();
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK((has_said || has_failed));
    CHECK(world.server.connection_count() == 2);
    CHECK(use(world.other) == status::Good);
    CHECK(say());
    return has_failed;
}

/// False if nothing failed when a client connected to a server that had no place for it: that of a
/// connection without a session, or none at all.
bool fail_without_place(bool is_one_idle, std::size_t k)
{
    server::ServerConfig config = FailureFixture::config();
    config.limits.max_connections_per_address = is_one_idle ? 3 : 2;
    FailureFixture world{false, config};
    const auto idle = is_one_idle ? world.open({}) : nullptr;
    std::optional<Result<server::Connection>> connected;
    fail_allocation(k);
    world.counted([&] { connected.emplace(world.server.connect("192.0.2.1", world.now)); });
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK((has_failed || (connected && connected->has_value() == is_one_idle)));
    connected.reset();
    CHECK(world.server.connect("192.0.2.1", world.now).has_value() == is_one_idle);
    CHECK(use(world.other) == status::Good);
    return has_failed;
}

/// False if the channel was renewed without a failure.
bool fail_renewal(const channel::SecuritySetting& security, bool has_worker, std::size_t k)
{
    FailureFixture world{has_worker};
    auto opened = world.open(security);
    REQUIRE(opened != nullptr);
    world.now = opened->channel.next_deadline();
    opened->channel.handle_deadline(world.now);
    fail_allocation(k);
    world.carry(*opened);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("allocation " << k << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK((opened->is_closed() ? has_failed : opened->create_session().has_value()));
    CHECK(use(world.other) == status::Good);
    return has_failed;
}

/// What a Read is told with no memory from the `k`-th allocation on; Good if it needs less.
StatusCode fail_from(std::size_t k, bool other_waits)
{
    FailureFixture world;
    const FailureCase asked = failing::read(world);
    if (other_waits) { // an answer that nobody takes
        static_cast<void>(asked.send(world.other));
        const auto sent = take_output(world.other.channel);
        REQUIRE(world.other.connection.feed(sent, world.now));
        REQUIRE_FALSE(world.other.connection.output().empty());
    }
    fail_allocation(k, 1'000'000);
    const StatusCode answer = world.ask(world.client, asked);
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO("from allocation " << k << " on: " << name(answer) << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK(has_failed == (answer != status::Good));
    return answer;
}

} // namespace

TEST_CASE("an allocation that fails while a channel is opened ends its connection")
{
    const bool has_worker = GENERATE(false, true);
    const channel::SecuritySetting security =
        has_worker ? secure : GENERATE(channel::SecuritySetting{}, secure);
    check_failing_worlds(
        "opening", [&](std::size_t k) { return fail_opening(security, has_worker, k); }, next);
}

TEST_CASE("an allocation that fails while the server calls a client ends the call")
{
    check_failing_worlds("ReverseHello", fail_reverse_hello);
}

TEST_CASE("an allocation that fails while there is no place for a client is told")
{
    const bool is_one_idle = GENERATE(false, true);
    check_failing_worlds("connecting",
                         [&](std::size_t k) { return fail_without_place(is_one_idle, k); });
}

TEST_CASE("an allocation that fails while a channel is renewed ends its connection")
{
    const bool has_worker = GENERATE(false, true);
    const channel::SecuritySetting security =
        has_worker ? secure : GENERATE(channel::SecuritySetting{}, secure);
    check_failing_worlds(
        "renewal", [&](std::size_t k) { return fail_renewal(security, has_worker, k); }, next);
}

TEST_CASE("an allocation that fails ends one request")
{
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.service)
        {
            check_failing_worlds(
                row.service, [&](std::size_t k) { return fail_once(row, k); }, next);
        }
    }
}

TEST_CASE("a server without memory for a while lives")
{
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.service)
        {
            check_failing_worlds(
                row.service, [&](std::size_t k) { return fail_for_a_while(row, k); },
                [](std::size_t k) { return k + 3; });
        }
    }
}

TEST_CASE("a request that finds no memory any more is told so, whoever has the buffer")
{
    const bool other_waits = GENERATE(false, true);
    bool is_told = false;
    check_failing_worlds("Read", [&](std::size_t k) {
        const StatusCode answer = fail_from(k, other_waits);
        // Until the message is put together nobody knows what was asked.
        CHECK((!is_told || answer == status::Bad_OutOfMemory || answer == status::Good));
        is_told = is_told || answer == status::Bad_OutOfMemory;
        return answer != status::Good;
    });
    CHECK(is_told);
}

} // namespace allocation_failure_test
