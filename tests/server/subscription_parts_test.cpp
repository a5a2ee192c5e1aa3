#include <algorithm>

#include <busbar/types/filter.hpp>

#include "bare_subscription.hpp"
#include "server/subscription/subscription_services.hpp"

namespace subscription_parts_test {

using namespace busbar;
using namespace busbar::server::detail;
using namespace busbar::test;
using namespace std::chrono_literals;

TEST_CASE("GetMonitoredItems and ResendData are there as functions")
{
    BareSubscription parts;
    Session other{1'000'000, 1'000'000};
    parts.add_item(7);
    parts.add_item(8);
    const std::uint32_t id = parts.subscription->id();

    const auto handles = get_monitored_items(parts.all, parts.session, id);
    REQUIRE(handles);
    CHECK(handles->server_handles == Array<std::uint32_t>{1, 2});
    CHECK(handles->client_handles == Array<std::uint32_t>{7, 8});
    CHECK(get_monitored_items(parts.all, parts.session, 0).error() ==
          status::Bad_SubscriptionIdInvalid);
    CHECK(get_monitored_items(parts.all, other, id).error() == status::Bad_UserAccessDenied);

    CHECK(parts.take() == 2);
    CHECK(resend_data(parts.all, parts.session, id, {}) == status::Good);
    CHECK(parts.take() == 2);
    CHECK(resend_data(parts.all, other, id, {}) == status::Bad_UserAccessDenied);
    CHECK(resend_data(parts.all, parts.session, 0, {}) == status::Bad_SubscriptionIdInvalid);
}

TEST_CASE("items sample what changes, by the timers of their Subscriptions")
{
    BareSubscription parts;
    parts.add_item(7);
    CHECK(parts.take() == 1);
    const TimePoint due = parts.all.next_deadline();
    CHECK(due > TimePoint{});
    parts.all.handle_deadline(due);
    CHECK(parts.take() == 0); // the same value
    parts.values.value = 2;
    parts.all.handle_deadline(parts.all.next_deadline());
    CHECK(parts.take() == 1);
}

TEST_CASE("an item gives back what it was charged, whatever filter it has got")
{
    BareSubscription parts;
    const ItemContext context{parts.all, *parts.subscription, {}};
    MemoryAccount& memory = parts.subscription->memory();
    const std::size_t before = memory.left();
    const std::size_t filters = GENERATE(0U, 1U, 2U, 3U);
    ValueItem* const item = parts.add_item(7, NodeId{0, id::Server_ServerStatus_State}, {});
    for (std::size_t i = 0; i < filters; ++i) { // one, none, one
        MonitoringParameters parameters;
        parameters.filter =
            i % 2 == 0 ? ExtensionObject::from(DataChangeFilter{}) : ExtensionObject{};
        ItemRevision revision;
        item->modify(context, parameters, TimestampsToReturn::Neither, revision);
        CHECK(revision.status == status::Good);
    }
    CHECK(memory.left() < before);
    CHECK(parts.subscription->remove_item(item->id()));
    CHECK(memory.left() == before);
}

TEST_CASE("where nobody makes event items there are none")
{
    BareSubscription parts;
    MonitoredItemCreateRequest request;
    ItemRevision revision;
    CHECK(parts.needs.event_items->make({parts.all, *parts.subscription, {}}, request, revision) ==
          nullptr);
    CHECK(revision.status == status::Bad_NotSupported);
}

TEST_CASE("Subscriptions that lost their session live on until somebody deletes them")
{
    BareSubscription parts;
    parts.add_item(7);
    CHECK(parts.all.item_count() == 1);
    parts.all.session_ends(parts.session, false);
    parts.session.publishing.reset(); // as the session takes it along
    CHECK(parts.all.size() == 1);
    CHECK(parts.subscription->session() == nullptr);
    CHECK(parts.all.find(parts.subscription->id(), parts.session) == nullptr);
    parts.all.remove(*parts.subscription);
    CHECK(parts.all.size() == 0);
    CHECK(parts.all.item_count() == 0);
}

TEST_CASE("all items of a variable share one copy of it, which is charged")
{
    constexpr std::size_t max_memory = 8U << 20U;
    LargeArray array{max_memory};
    const std::size_t before = array.parts.all.memory().left();
    array.parts.add_item(0, array.curve, "0");
    const std::size_t one = before - array.parts.all.memory().left();
    CHECK(one > LargeArray::bytes);
    CHECK(one < LargeArray::bytes + 4'096);
    for (std::uint32_t handle = 1; handle < 1'000; ++handle) {
        array.parts.add_item(handle, array.curve, "0");
    }
    CHECK(before - array.parts.all.memory().left() <
          LargeArray::bytes + std::size_t{4'096} * 1'000);
    CHECK(array.parts.take() == 1'000);
    array.parts.all.session_ends(array.parts.session, true);
    while (array.parts.all.next_deadline() != no_deadline) {
        array.parts.all.handle_deadline(array.parts.all.next_deadline());
    }
    CHECK(array.parts.all.memory().left() == max_memory);
}

TEST_CASE("a variable that nobody can pay a copy of is looked at each time")
{
    LargeArray array{512U << 10U};
    array.parts.add_item(1, array.curve, "7");
    array.parts.add_item(2, array.curve, "8");
    CHECK(array.parts.take() == 2);
    array.scan(7, 1.5);
    array.parts.all.handle_deadline(array.parts.all.next_deadline());
    CHECK(array.parts.take() == 1);
    array.scan(8, 1.5);
    array.parts.all.handle_deadline(array.parts.all.next_deadline());
    CHECK(array.parts.take() == 2);
}

TEST_CASE("an item that comes to a variable takes no change from the others")
{
    LargeArray array{8U << 20U};
    array.parts.add_item(1, array.curve, "7");
    CHECK(array.parts.take() == 1);
    array.scan(7, 1.5);
    array.parts.add_item(2, array.curve, "7"); // sees the new value before item 1 is sampled
    CHECK(array.parts.take() == 1);
    array.parts.all.handle_deadline(array.parts.all.next_deadline());
    CHECK(array.parts.take() == 1);
}

} // namespace subscription_parts_test
