#include <catch2/catch.hpp>

#include <busbar/types/filter.hpp>

#include "subscription_fixture.hpp"

namespace subscription_size_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

constexpr Duration cycle = 100ms;

Variant text_of(std::size_t size)
{
    return Variant{String{std::string(size, 'x')}};
}

/// A client that takes responses of 10,000 bytes.
struct SizeFixture : SubscriptionFixture {
    SizeFixture() : client{connect()}
    {
        auto create = client.create_request();
        create.max_response_message_size = 10'000;
        REQUIRE(client.create_session(create));
        REQUIRE(client.activate(client.anonymous()) == status::Good);
        id = subscribe(client);
    }
    NodeId add_text(const char* name, std::size_t size)
    {
        return SubscriptionFixture::add_variable(name, text_of(size), id::String);
    }
    void monitor_text(const NodeId& text, std::uint32_t handle)
    {
        CHECK(monitor(client, id, item_request(text, handle)).status_code == status::Good);
    }

    TestClient client;
    std::uint32_t id{0};
};

} // namespace

// Part 4, 7.22.3 says it of fields of events; a value is the one field of its Notification.
TEST_CASE_METHOD(SizeFixture, "a value that no response can take is told as such")
{
    const NodeId small = add_text("small", 10);
    const NodeId large = add_text("large", 20'000);
    monitor_text(small, 1);
    monitor_text(large, 2);
    monitor_text(small, 3);
    publish(client);
    publish(client);
    const auto values = next_data(client, cycle);
    REQUIRE(values.size() == 3);
    CHECK(values[0].value == DataValue{text_of(10)});
    CHECK(values[1].value == DataValue{status::Bad_EncodingLimitsExceeded});
    CHECK(values[2].value == DataValue{text_of(10)});
    const auto again = republish(client, id, 2);
    REQUIRE(again);
    CHECK(data(again->notification_message)[0] == values[1]);

    // The item goes on with what fits again.
    set(1, text_of(11));
    const auto next = next_data(client, cycle);
    REQUIRE(next.size() == 1);
    CHECK(next[0].value == DataValue{text_of(11)});
}

TEST_CASE_METHOD(SizeFixture, "a value that fits by itself waits for the next message")
{
    monitor_text(add_text("small", 2'000), 1);
    monitor_text(add_text("large", 9'000), 2);
    publish(client);
    const auto values = next_data(client, cycle);
    REQUIRE(values.size() == 2);
    CHECK(values[0].value == DataValue{text_of(2'000)});
    CHECK(values[1].value == DataValue{text_of(9'000)});
}

TEST_CASE_METHOD(SizeFixture, "of what is larger than messages should be one goes by itself")
{
    auto limits = small_limits();
    limits.max_message_size = 1'000;
    SubscriptionFixture fixture{limits};
    const NodeId large = fixture.add_variable("large", text_of(5'000), id::String);
    auto other = fixture.log_in();
    const auto subscription = fixture.subscribe(other);
    fixture.monitor(other, subscription, fixture.item_request(large, 1));
    fixture.monitor(other, subscription, fixture.item_request(large, 2));
    const auto request = fixture.publish(other);
    fixture.advance(cycle);
    const auto response = fixture.take(other, request);
    REQUIRE(response);
    CHECK(response->more_notifications);
    const auto values = fixture.data(response->notification_message);
    REQUIRE(values.size() == 1);
    CHECK(values[0].value == DataValue{text_of(5'000)});
}

} // namespace subscription_size_test
