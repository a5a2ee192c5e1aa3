#include <array>

#include "failure_cases.hpp"
#include "server/engine/event_item_queue.hpp"
#include "server/subscription/sampling_intervals.hpp"
#include "server/subscription/timer_queue.hpp"
#include "support/failing_worlds.hpp"

namespace subscription_allocation_failure_test {

/// Counts and timers of Subscriptions and their items when there is no memory to end them.
using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t most_items = 30;
constexpr std::size_t most_subscriptions = 3;

server::ServerConfig counting_config()
{
    server::ServerConfig config = FailureFixture::config();
    config.limits.subscriptions.max_items_per_user = most_items;
    config.limits.subscriptions.max_subscriptions_per_user = most_subscriptions;
    config.limits.subscriptions.max_subscriptions_per_session = most_subscriptions;
    return config;
}

/// A user with two Subscriptions, one of them empty, the other with more items than are removed at
/// once and of several kinds, in which Notifications wait.
class CountingWorld : public FailureFixture {
public:
    CountingWorld() : FailureFixture{false, counting_config()}
    {
        add_range();
        client = log_in_as("operator");
        kept = make_subscription();
        filled = make_subscription();
        for (int i = 0; i < 9; ++i) {
            keep_items(items_request(filled));
        }
        keep_items(failing::event_item(filled));
        CreateMonitoredItemsRequest others = items_request(filled);
        others.items_to_create[0].item_to_monitor.node_id = own("range");
        others.items_to_create[1].monitoring_mode = MonitoringMode::Disabled;
        keep_items(others);
        SetTriggeringRequest triggering;
        triggering.subscription_id = filled;
        triggering.triggering_item_id = items[0];
        triggering.links_to_add = {items[1], items[2]};
        REQUIRE(client.call<SetTriggeringResponse>(triggering));
        queue_notifications();
    }

    /// Whatever is left of the items can be removed, and then there is as much room as ever.
    void check_counts()
    {
        for (TestClient* const each : {&client, left.get()}) {
            if (each != nullptr && each->is_closed()) {
                *each = again(*each);
            }
        }
        for (TestClient* const each : {&client, left.get()}) {
            if (each != nullptr) {
                DeleteSubscriptionsRequest request;
                request.subscription_ids = {filled};
                CHECK(each->call<DeleteSubscriptionsResponse>(request));
            }
        }
        for (int i = 0; i < 5; ++i) {
            pass(100ms, client);
        }
        CHECK(server.subscription_count() == 1);
        CHECK(server.monitored_item_count() == 0);
        TestClient& owner = left != nullptr ? *left : client;
        CHECK(count_new_items(owner, most_items + 1) == most_items);
        std::size_t made = 0;
        while (made < 2 * most_subscriptions &&
               owner.call<CreateSubscriptionResponse>(subscription_request())) {
            ++made;
        }
        CHECK(made == most_subscriptions - 1);
    }

    [[nodiscard]] static server::Event event()
    {
        server::Event event;
        event.message = LocalizedText{"a message that does not fit into a small string"};
        event.severity = 500;
        event.source_node = NodeId{0, id::Server};
        return event;
    }

    std::uint32_t kept{0};
    std::uint32_t filled{0};
    std::vector<std::uint32_t> items;

private:
    void add_range()
    {
        model::NewNode node;
        node.id = own("range");
        node.browse_name = QualifiedName{1, "range"};
        node.parent = server.address_space().find(id::ObjectsFolder);
        model::NewVariable variable;
        variable.data_type = NodeId{0, id::Range};
        variable.value = Variant{ExtensionObject::from(Range{0, 100})};
        REQUIRE(server.address_space().add_variable(node, variable));
    }
    /// It outlives the test.
    std::uint32_t make_subscription()
    {
        CreateSubscriptionRequest request = subscription_request();
        request.requested_lifetime_count = 10'000;
        const auto made = client.call<CreateSubscriptionResponse>(request);
        REQUIRE(made);
        return made->subscription_id;
    }
    void keep_items(const CreateMonitoredItemsRequest& request)
    {
        const auto made = client.call<CreateMonitoredItemsResponse>(request);
        REQUIRE(made);
        REQUIRE(worst_of(*made) == status::Good);
        for (const MonitoredItemCreateResult& result : made->results) {
            items.push_back(result.monitored_item_id);
        }
    }
    void queue_notifications()
    {
        model::AddressSpace& space = server.address_space();
        for (int i = 1; i <= 3; ++i) {
            REQUIRE(space.set_value(space.find(own("range")),
                                    Variant{ExtensionObject::from(Range{0, 1.0 * i})}));
            REQUIRE(server.raise_event(event()));
            pass(100ms, client);
        }
    }
    /// How many more items it can have, up to `most`.
    [[nodiscard]] std::size_t count_new_items(TestClient& owner, std::size_t most) const
    {
        CreateMonitoredItemsRequest request = items_request(kept);
        request.items_to_create.resize(1);
        for (std::size_t made = 0; made < most; ++made) {
            const auto response = owner.call<CreateMonitoredItemsResponse>(request);
            REQUIRE(response);
            if (worst_of(*response).is_bad()) {
                return made;
            }
        }
        return most;
    }
};

FailureCase delete_items(CountingWorld& world)
{
    DeleteMonitoredItemsRequest request;
    request.subscription_id = world.filled;
    request.monitored_item_ids = Array<std::uint32_t>{world.items};
    return asking<DeleteMonitoredItemsResponse>(request);
}

FailureCase delete_subscriptions(CountingWorld& world)
{
    DeleteSubscriptionsRequest request;
    request.subscription_ids = {world.filled};
    return asking<DeleteSubscriptionsResponse>(request);
}

FailureCase transfer_subscriptions(CountingWorld& world)
{
    TransferSubscriptionsRequest request;
    request.subscription_ids = {world.filled};
    request.send_initial_values = true;
    world.left = std::make_unique<TestClient>(std::move(world.client));
    world.client = world.log_in_as("operator");
    return asking<TransferSubscriptionsResponse>(request);
}

struct Row {
    const char* service;
    FailureCase (*prepare)(CountingWorld&);
};

constexpr Row rows[] = {
    {"DeleteMonitoredItems", delete_items},
    {"DeleteSubscriptions", delete_subscriptions},
    {"TransferSubscriptions", transfer_subscriptions},
};

/// False if nothing failed of the request and of what is done in the time after it.
bool fail_once(const Row& row, std::size_t k, std::size_t most)
{
    CountingWorld world;
    const FailureCase asked = row.prepare(world);
    fail_allocation(k, most);
    const StatusCode answer = world.ask(world.client, asked);
    for (int i = 0; i < 3; ++i) {
        world.pass(100ms, world.client);
    }
    const bool has_failed = has_allocation_failed();
    fail_allocation(0);
    INFO(row.service << ", allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    CHECK(world.thrown == 0);
    CHECK((has_failed || answer == status::Good));
    world.check_counts();
    return has_failed;
}

/// False if nothing failed when an item of events was enabled; the same request enables it then.
bool fail_to_enable_events(std::size_t k, std::size_t most)
{
    FailureFixture world;
    SetMonitoringModeRequest request;
    request.subscription_id = world.subscribe();
    CreateMonitoredItemsRequest item = failing::event_item(request.subscription_id);
    item.items_to_create[0].monitoring_mode = MonitoringMode::Disabled;
    const auto made = world.client.call<CreateMonitoredItemsResponse>(item);
    REQUIRE(made);
    request.monitoring_mode = MonitoringMode::Reporting;
    request.monitored_item_ids = {made->results[0].monitored_item_id};
    const FailureCase asked = asking<SetMonitoringModeResponse>(request);
    const auto [answer, has_failed] = world.attempt(asked, k, most);
    INFO("allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    if (answer != status::Good) {
        CHECK(world.ask(world.client, asked) == status::Good);
    }
    REQUIRE(world.server.raise_event(CountingWorld::event()));
    CHECK(world.ask(world.client, failing::publish_something()) == status::Good);
    return has_failed;
}

/// False if nothing failed when a session was closed that leaves two Subscriptions behind. It is
/// either gone or as it was.
bool fail_to_close(std::size_t k, std::size_t most)
{
    FailureFixture world;
    DeleteSubscriptionsRequest own;
    own.subscription_ids = {world.subscribe(), world.subscribe()};
    CloseSessionRequest request;
    request.delete_subscriptions = false;
    const auto [answer, has_failed] = world.attempt(asking<CloseSessionResponse>(request), k, most);
    INFO("allocation " << k << ": " << name(answer) << "\n" << world.log.text);
    if (world.server.session_count() == 2) {
        world.client = world.again(world.client);
        CHECK(world.ask(world.client, asking<DeleteSubscriptionsResponse>(own)) == status::Good);
    }
    CHECK(use(world.other) == status::Good);
    return has_failed;
}

/// Sets itself again.
struct SteadyTimer final : server::detail::Timer {
    void expire(TimePoint now) override
    {
        if (is_broken) {
            throw std::bad_alloc{};
        }
        queue->set(*this, now + 1s);
    }

    server::detail::TimerQueue* queue{nullptr};
    bool is_broken{false};
};

} // namespace

TEST_CASE("an allocation that fails while items are removed leaves every count right")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    for (const Row& row : rows) {
        DYNAMIC_SECTION(row.service << ", " << most)
        {
            check_failing_worlds(row.service,
                                 [&](std::size_t k) { return fail_once(row, k, most); });
        }
    }
}

TEST_CASE("an item of events that found no memory when it was enabled is so the next time")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("SetMonitoringMode",
                         [&](std::size_t k) { return fail_to_enable_events(k, most); });
}

TEST_CASE("a session that found no memory for its end is as it was")
{
    const std::size_t most = GENERATE(1U, 1'000'000U); // or there is no memory any more
    check_failing_worlds("CloseSession", [&](std::size_t k) { return fail_to_close(k, most); });
}

TEST_CASE("a Subscription whose client could not be told of its end ends later")
{
    FailureFixture world{false, FailureFixture::config()};
    world.client = world.log_in_as("operator");
    const auto made =
        world.client.call<CreateSubscriptionResponse>(FailureFixture::subscription_request());
    REQUIRE(made);
    const std::uint32_t subscription = made->subscription_id;
    const Duration interval =
        std::chrono::milliseconds{static_cast<std::int64_t>(made->revised_publishing_interval)};
    const auto wait = [&](std::uint32_t intervals) {
        for (std::uint32_t i = 0; i < intervals; ++i) {
            world.pass(interval, world.client);
        }
    };
    wait(made->revised_lifetime_count - 2);
    fail_allocation(1, 1'000'000);
    wait(6);
    CHECK(world.server.subscription_count() == 1);
    fail_allocation(0);
    wait(20);
    CHECK(world.server.subscription_count() == 0);
    const auto response = world.client.call<PublishResponse>(PublishRequest{});
    REQUIRE(response);
    CHECK(response->subscription_id == subscription);
    REQUIRE(response->notification_message.notification_data.size() == 1);
    const auto* const change =
        response->notification_message.notification_data[0].get_if<StatusChangeNotification>();
    REQUIRE(change != nullptr);
    CHECK(change->status == status::Bad_Timeout);
}

TEST_CASE("a timer that expires can be set again whatever memory there is")
{
    constexpr std::size_t most_others = 8;
    for (std::size_t others = 0; others <= most_others; ++others) {
        server::detail::TimerQueue queue;
        std::array<SteadyTimer, 4> timers;
        std::array<SteadyTimer, most_others> later;
        for (SteadyTimer& timer : timers) {
            timer.queue = &queue;
            queue.set(timer, TimePoint{1s});
        }
        timers[0].is_broken = true; // which leaves the others behind
        CHECK_THROWS_AS(queue.expire(TimePoint{1s}), std::bad_alloc);
        for (std::size_t i = 0; i < others; ++i) {
            queue.set(later[i], TimePoint{1h});
        }
        fail_allocation(1, 1'000'000);
        static_cast<void>(survives_counted([&] { queue.expire(TimePoint{1s}); }));
        fail_allocation(0);
        queue.expire(TimePoint{1s});
        INFO(others << " others");
        for (std::size_t i = 1; i < timers.size(); ++i) {
            CHECK(timers[i].due() == TimePoint{2s});
        }
        CHECK(queue.size() == timers.size() - 1 + others);
    }
}

TEST_CASE("what finds no memory in the queue of an event item is neither counted nor paid for")
{
    using Queue = server::detail::EventItemQueue;
    constexpr std::size_t all = 1U << 20U;
    const bool is_overflow = GENERATE(false, true);
    bool has_failed = true;
    for (std::size_t k = 1; has_failed; ++k) {
        server::detail::MemoryAccount account{all, nullptr};
        Queue queue{account};
        REQUIRE(queue.set_capacity(100, true));
        fail_allocation(k);
        static_cast<void>(survives_counted([&] {
            for (int i = 0; i < 50; ++i) {
                if (is_overflow) {
                    queue.push_overflow(Queue::Fields{});
                } else {
                    static_cast<void>(queue.push(Queue::Fields{}));
                }
            }
        }));
        has_failed = has_allocation_failed();
        fail_allocation(0);
        INFO("allocation " << k);
        queue.clear();
        CHECK(account.left() == all);
        REQUIRE(queue.set_capacity(2, true));
        for (int i = 0; i < 3; ++i) {
            CHECK(queue.push(Queue::Fields{}) == (i < 2));
        }
        CHECK(queue.size() == 2);
    }
}

TEST_CASE("an item whose new sampling interval finds no memory is counted at the old one")
{
    server::detail::SamplingIntervals intervals{true};
    const server::detail::SamplingIntervals::Use use{false, 100ms};
    const server::detail::SamplingIntervals::Use next{false, 200ms};
    intervals.change({}, use);
    fail_allocation(1);
    CHECK_FALSE(survives_counted([&] { intervals.change(use, next); }));
    fail_allocation(0);
    CHECK(intervals.all().at(100ms).enabled == 1);
    intervals.change(use, {});
    CHECK(intervals.all().at(100ms).enabled == 0);
}

} // namespace subscription_allocation_failure_test
