#include <catch2/catch.hpp>

#include "puppet_fixture.hpp"

namespace subscription_publishing_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using Values = std::vector<std::int32_t>;

namespace {

/// Two Subscriptions, 7 and 8 at the server; the second one has no items.
struct TwoSubscriptions : PuppetFixture {
    TwoSubscriptions()
    {
        start();
        publish(message(1));
        second = subscriptions.create({}, others.handlers()).value();
        settle();
        static_cast<void>(requester.take<CreateSubscriptionRequest>());
        reply(created(8));
    }

    SubscriptionHandle second{0};
    Heard others;
};

} // namespace

TEST_CASE_METHOD(TwoSubscriptions, "A server that says it has no Subscription is asked for each",
                 "[client]")
{
    static_cast<void>(requester.take<PublishRequest>());
    refuse(status::Bad_NoSubscription);
    auto request = requester.take<RepublishRequest>();
    CHECK(request.subscription_id == 7);
    CHECK(request.retransmit_sequence_number == 2);
    refuse(status::Bad_MessageNotAvailable); // it is there
    request = requester.take<RepublishRequest>();
    CHECK(request.subscription_id == 8);
    refuse(status::Bad_SubscriptionIdInvalid);
    CHECK(subscriptions.mode(subscription) == DeliveryMode::Publishing);
    CHECK(subscriptions.mode(second) == DeliveryMode::None);
    CHECK(others.statuses.back().first == status::Bad_SubscriptionIdInvalid);
    pass(1s);
    CHECK(requester.count<CreateSubscriptionRequest>() == 1);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0);
    publish(message(2));
    CHECK(heard.take_values() == Values{1, 2});
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "An acknowledgement that finds no Subscription has it made anew",
                 "[client]")
{
    start();
    publish(message(1));
    publish(message(2));
    const auto request = requester.take<PublishRequest>();
    REQUIRE(request.subscription_acknowledgements.size() == 1);
    PublishResponse response;
    response.subscription_id = 99;
    response.results = {status::Bad_SubscriptionIdInvalid};
    reply(response);
    CHECK(heard.statuses.back() ==
          std::pair{StatusCode{status::Bad_SubscriptionIdInvalid}, DeliveryMode::None});
    pass(1s);
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created(8));
    make_items();
    static_cast<void>(requester.take<SetPublishingModeRequest>());
    SetPublishingModeResponse enabled;
    enabled.results = {status::Good};
    reply(enabled);
    auto first = message(1);
    first.publish_time = time_of(9);
    publish(first, 8);
    CHECK(heard.take_values() == Values{1, 2, 1});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_SubscriptionIdInvalid);
    CHECK(heard.gaps[0].from == time_of(2));
    CHECK(heard.gaps[0].to == time_of(9));
}

TEST_CASE_METHOD(PuppetFixture, "A Republish that brings another message brings none", "[client]")
{
    start();
    publish(message(1));
    publish(message(3));
    CHECK(requester.take<RepublishRequest>().retransmit_sequence_number == 2);
    RepublishResponse response;
    response.notification_message = message(5);
    reply(response);
    CHECK(heard.take_values() == Values{1, 3});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_MessageNotAvailable);
    CHECK(heard.gaps[0].to == time_of(3));
}

TEST_CASE_METHOD(PuppetFixture, "A message that comes twice at a time is told once", "[client]")
{
    start();
    publish(message(1));
    publish(message(3));
    CHECK(requester.count<RepublishRequest>() == 1);
    publish(message(2)); // late, but not lost
    if (GENERATE(true, false)) {
        republish(2);
    } else {
        refuse_republish(2);
    }
    CHECK(heard.take_values() == Values{1, 2, 3});
    CHECK(heard.gaps.empty());
    publish(message(4));
    CHECK(heard.take_values() == Values{4});
}

TEST_CASE_METHOD(PuppetFixture, "A message without a time has that of its response", "[client]")
{
    start();
    static_cast<void>(requester.take<PublishRequest>());
    PublishResponse response;
    response.subscription_id = server_id;
    response.response_header.timestamp = time_of(50);
    response.notification_message = message(1);
    response.notification_message.publish_time = {};
    reply(response);
    auto third = message(3);
    third.publish_time = time_of(60);
    publish(third);
    refuse_republish(2);
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].from == time_of(50));
    CHECK(heard.gaps[0].to == time_of(60));
}

TEST_CASE_METHOD(PuppetFixture, "A message that is republished without a time has one, too",
                 "[client]")
{
    start();
    publish(message(1));
    publish_keep_alive(3);
    static_cast<void>(requester.take<RepublishRequest>());
    RepublishResponse response;
    response.response_header.timestamp = time_of(50);
    response.notification_message = message(2);
    response.notification_message.publish_time = {};
    reply(response);
    auto fourth = message(4);
    fourth.publish_time = time_of(60);
    publish(fourth);
    refuse_republish(3);
    CHECK(heard.take_values() == Values{1, 2, 4});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].from == time_of(50));
    CHECK(heard.gaps[0].to == time_of(60));
}

TEST_CASE_METHOD(PuppetFixture, "A leap leaves out no message that is here", "[client]")
{
    start();
    publish(message(1));
    publish(message(3)); // waits for the second
    publish(message(5'000));
    CHECK(heard.take_values() == Values{1, 3, 5'000});
    REQUIRE(heard.gaps.size() == 2);
    for (const client::Gap& gap : heard.gaps) {
        CHECK(gap.reason == status::Bad_SequenceNumberUnknown);
    }
    CHECK(heard.gaps[0].from == time_of(1));
    CHECK(heard.gaps[0].to == time_of(3));
    CHECK(heard.gaps[1].from == time_of(3));
    CHECK(heard.gaps[1].to == time_of(5'000));
    refuse_republish(2); // too late to matter
    publish(message(5'001));
    CHECK(heard.take_values() == Values{5'001});
    CHECK(heard.gaps.size() == 2);
}

TEST_CASE_METHOD(PuppetFixture, "A message that comes before its Subscription is fetched again",
                 "[client]")
{
    start();
    Heard others;
    const auto second = subscriptions.create({}, others.handlers()).value();
    settle();
    publish(message(1), 8);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0); // it may become ours
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created(8));
    CHECK(subscriptions.server_id(second) == 8);
    publish(message(2), 8);
    const auto request = requester.take<RepublishRequest>();
    CHECK(request.subscription_id == 8);
    CHECK(request.retransmit_sequence_number == 1);
    refuse(status::Bad_MessageNotAvailable);
    CHECK(others.gaps.size() == 1);
    CHECK(heard.gaps.empty());
}

} // namespace subscription_publishing_test
