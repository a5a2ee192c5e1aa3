#include <catch2/catch.hpp>

#include "puppet_fixture.hpp"

namespace subscription_loss_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::DeliveryMode;
using Start = Subscriptions::SessionStart;
using Values = std::vector<std::int32_t>;

TEST_CASE_METHOD(PuppetFixture, "A message is acknowledged when it was delivered", "[client]")
{
    start();
    CHECK(requester.count<PublishRequest>() == 2);
    publish(message(2)); // the first is missing
    CHECK(heard.data.empty());
    CHECK(publish({3, {}, {}}).subscription_acknowledgements.empty());
    republish(1);
    CHECK(heard.take_values() == Values{1, 2});
    // Those that were under way have no acknowledgements; the next ones have.
    std::vector<std::uint32_t> acknowledged;
    for (int i = 0; i < 4; ++i) {
        for (const auto& one : publish(message(2)).subscription_acknowledgements) {
            acknowledged.push_back(one.sequence_number);
        }
    }
    CHECK(heard.data.empty()); // it came twice
    REQUIRE(acknowledged.size() >= 2);
    CHECK(acknowledged[0] == 1);
    CHECK(acknowledged[1] == 2);
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "Acknowledgements of a Publish that failed are made again",
                 "[client]")
{
    start();
    publish(message(1));
    publish_keep_alive(2);
    // The request sent after the first message has its acknowledgement.
    auto request = requester.take<PublishRequest>();
    REQUIRE(request.subscription_acknowledgements.size() == 1);
    refuse(status::Bad_Timeout);
    pass(1s);
    publish_keep_alive(2);
    request = requester.take<PublishRequest>();
    REQUIRE(request.subscription_acknowledgements.size() == 1);
    CHECK(request.subscription_acknowledgements[0].sequence_number == 1);
    CHECK(request.subscription_acknowledgements[0].subscription_id == server_id);
}

TEST_CASE_METHOD(PuppetFixture, "Messages that the server no longer has are one Gap", "[client]")
{
    start();
    publish(message(1));
    publish(message(4));
    refuse_republish(2);
    refuse_republish(3);
    CHECK(heard.take_values() == Values{1, 4});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_MessageNotAvailable);
    CHECK(heard.gaps[0].from == time_of(1));
    CHECK(heard.gaps[0].to == time_of(4));
    CHECK(heard.gaps[0].subscription == subscription);
}

TEST_CASE_METHOD(PuppetFixture, "A keep-alive message tells what is missing", "[client]")
{
    start();
    publish(message(1));
    publish_keep_alive(3);
    refuse_republish(2);
    publish_keep_alive(3);
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].from == time_of(1));
    CHECK(heard.gaps[0].to == time_of(3));
    publish_keep_alive(3);
    CHECK(heard.gaps.size() == 1);
    publish(message(3));
    CHECK(heard.take_values() == Values{1, 3});
}

TEST_CASE_METHOD(PuppetFixture, "A leap of sequence numbers is one Gap", "[client]")
{
    start();
    publish(message(1));
    publish(message(0x1000'0000));
    CHECK(requester.count<RepublishRequest>() == 0);
    CHECK(heard.take_values() == Values{1, 0x1000'0000});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].reason == status::Bad_SequenceNumberUnknown);
    publish_keep_alive(0x2000'0000);
    CHECK(heard.gaps.size() == 2);
}

TEST_CASE_METHOD(PuppetFixture, "A resumed session is asked for what it has", "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    CHECK(requester.open_count() == 0);
    CHECK(subscriptions.next_deadline() == no_deadline);
    subscriptions.session_started(Start::Resumed);
    settle();
    republish(2);
    republish(3);
    refuse_republish(4);
    CHECK(requester.count<RepublishRequest>() == 0);
    CHECK(heard.take_values() == Values{1, 2, 3});
    const auto request = publish(message(4));
    CHECK(heard.take_values() == Values{4});
    CHECK(request.subscription_acknowledgements.size() == 3); // nothing was published before
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "Kept messages are fetched before more is asked for", "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    const bool is_resumed = GENERATE(true, false);
    subscriptions.session_started(is_resumed ? Start::Resumed : Start::New);
    settle();
    if (!is_resumed) {
        static_cast<void>(requester.take<TransferSubscriptionsRequest>());
        CHECK(requester.count<PublishRequest>() == 0);
        TransferSubscriptionsResponse response;
        response.results.push_back({status::Good, {2}});
        reply(response);
    }
    CHECK(requester.count<PublishRequest>() == 0);
    republish(2);
    CHECK(requester.count<PublishRequest>() == 0);
    SECTION("until there is none")
    {
        refuse_republish(3);
    }
    SECTION("until the server has answered something else")
    {
        leave_republish_unanswered();
        static_cast<void>(requester.take<ReadRequest>());
        reply(ReadResponse{});
        CHECK(requester.count<PublishRequest>() == 0);
        static_cast<void>(requester.take<RepublishRequest>());
        refuse(status::Bad_Timeout);
    }
    SECTION("while nothing is answered at all")
    {
        for (int i = 0; i < 3; ++i) {
            leave_republish_unanswered();
            static_cast<void>(requester.take<ReadRequest>());
            refuse(status::Bad_Timeout);
        }
        refuse_republish(3);
    }
    SECTION("by a link that was too slow for a while")
    {
        leave_republish_unanswered();
        static_cast<void>(requester.take<ReadRequest>());
        reply(ReadResponse{});
        refuse_republish(3);
    }
    CHECK(requester.count<PublishRequest>() == 2);
    publish(message(3));
    CHECK(heard.take_values() == Values{1, 2, 3});
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "A connection is as patient as the one before it", "[client]")
{
    start();
    publish(message(1));
    publish(message(3)); // the second is missing
    const auto leave_unanswered = [this] {
        static_cast<void>(requester.take<RepublishRequest>());
        refuse(status::Bad_Timeout);
        pass(1s);
    };
    for (int i = 0; i < 3; ++i) {
        leave_unanswered();
    }
    static_cast<void>(requester.take<ReadRequest>()); // does it answer anything?
    subscriptions.session_lost();
    subscriptions.session_started(Start::Resumed);
    settle();
    leave_unanswered();
    republish(2);
    CHECK(heard.take_values() == Values{1, 2, 3});
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "A Subscription that a new session may not have is made anew",
                 "[client]")
{
    start(3);
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    const auto transfer = requester.take<TransferSubscriptionsRequest>();
    CHECK(transfer.subscription_ids == Array<std::uint32_t>{server_id});
    CHECK_FALSE(transfer.send_initial_values);
    const StatusCode refusal = status::Bad_UserAccessDenied;
    SECTION("by the Service")
    {
        refuse(refusal);
    }
    SECTION("one by one")
    {
        TransferSubscriptionsResponse response;
        response.results.resize(1);
        response.results[0].status_code = refusal;
        reply(response);
    }
    SECTION("with too few results")
    {
        reply(TransferSubscriptionsResponse{});
    }
    CHECK(heard.statuses.back().second == DeliveryMode::None);
    pass(2s);
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids[0] == server_id);
    refuse(status::Bad_SubscriptionIdInvalid);
    // It begins when its items are there.
    CHECK_FALSE(requester.take<CreateSubscriptionRequest>().publishing_enabled);
    reply(created(8));
    make_items();
    CHECK(requester.take<SetPublishingModeRequest>().publishing_enabled);
    SetPublishingModeResponse enabled;
    enabled.results = {status::Good};
    reply(enabled);
    CHECK(heard.gaps.empty());
    auto first = message(1);
    first.publish_time = time_of(50);
    publish(first, 8);
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].from == time_of(1));
    CHECK(heard.gaps[0].to == time_of(50));
    CHECK(heard.take_values() == Values{1, 1});
}

TEST_CASE_METHOD(PuppetFixture, "A transferred Subscription goes on where it was", "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    static_cast<void>(requester.take<TransferSubscriptionsRequest>());
    TransferSubscriptionsResponse response;
    response.results.resize(1);
    response.results[0].available_sequence_numbers = {1, 3};
    reply(response);
    refuse_republish(2);
    republish(3);
    refuse_republish(4);
    CHECK(heard.take_values() == Values{1, 3});
    REQUIRE(heard.gaps.size() == 1);
    CHECK(heard.gaps[0].to == time_of(3));
}

TEST_CASE_METHOD(PuppetFixture, "A transfer that is not answered is tried again", "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    static_cast<void>(requester.take<TransferSubscriptionsRequest>());
    pass(60s);
    CHECK(requester.count<TransferSubscriptionsRequest>() == 1);
    CHECK(requester.count<CreateSubscriptionRequest>() == 0);
    subscriptions.session_lost();
    subscriptions.session_started(Start::Resumed); // what became of it?
    settle();
    CHECK(requester.count<TransferSubscriptionsRequest>() == 1);
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "A Subscription whose transfer is never answered is created again",
                 "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    for (int i = 0; i < 10; ++i) {
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
        static_cast<void>(requester.take<TransferSubscriptionsRequest>());
        refuse(status::Bad_Timeout);
        pass(1s);
    }
    CHECK(requester.count<TransferSubscriptionsRequest>() == 0);
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 1); // it may be this session's
    CHECK(requester.count<CreateSubscriptionRequest>() == 1);
    // The pause after a failure is the first one, not one of ten failures.
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    refuse(status::Bad_TooManyOperations);
    pass(2s);
    CHECK(requester.count<CreateSubscriptionRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "A transfer that found no memory is tried again", "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    const bool is_whole = GENERATE(false, true); // of the service, or of the one Subscription
    const auto refuse_transfer = [&] {
        CHECK(requester.take<TransferSubscriptionsRequest>().subscription_ids ==
              Array<std::uint32_t>{server_id});
        TransferSubscriptionsResponse response;
        response.results.resize(1);
        response.results[0].status_code = status::Bad_OutOfMemory;
        if (is_whole) {
            refuse(status::Bad_OutOfMemory);
        } else {
            reply(response);
        }
    };
    SECTION("until there is some")
    {
        for (int i = 0; i < 9; ++i) {
            refuse_transfer();
            CHECK(requester.count<TransferSubscriptionsRequest>() == 0); // not at once
            pass(1s);
        }
        static_cast<void>(requester.take<TransferSubscriptionsRequest>());
        TransferSubscriptionsResponse response;
        response.results.resize(1);
        reply(response);
        refuse_republish(2);
        publish(message(2));
        CHECK(heard.take_values() == Values{1, 2});
        CHECK(heard.gaps.empty());
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
    }
    SECTION("but not for ever")
    {
        for (int i = 0; i < 10; ++i) {
            refuse_transfer();
            pass(1s);
        }
        CHECK(requester.count<TransferSubscriptionsRequest>() == 0);
        CHECK(requester.count<DeleteSubscriptionsRequest>() == 1);
        CHECK(requester.count<CreateSubscriptionRequest>() == 1);
    }
    SECTION("unless the session is lost once more")
    {
        refuse_transfer();
        subscriptions.session_lost();
        subscriptions.session_started(Start::Resumed);
        settle();
        CHECK(requester.count<TransferSubscriptionsRequest>() == 1);
    }
}

TEST_CASE_METHOD(PuppetFixture, "A transfer that was carried out though no answer came is one",
                 "[client]")
{
    start();
    publish(message(1));
    subscriptions.session_lost();
    subscriptions.session_started(Start::New);
    settle();
    static_cast<void>(requester.take<TransferSubscriptionsRequest>());
    subscriptions.session_lost();
    subscriptions.session_started(Start::Resumed);
    settle();
    static_cast<void>(requester.take<TransferSubscriptionsRequest>());
    TransferSubscriptionsResponse response;
    response.results.resize(1);
    response.results[0].status_code = status::Bad_NothingToDo; // it is this session's already
    reply(response);
    republish(2);
    refuse_republish(3);
    CHECK(heard.take_values() == Values{1, 2});
    publish(message(3));
    CHECK(heard.take_values() == Values{3});
    CHECK(heard.gaps.empty());
    CHECK(requester.count<CreateSubscriptionRequest>() == 0);
}

TEST_CASE_METHOD(PuppetFixture, "A Subscription that has ended at the server is made anew",
                 "[client]")
{
    start();
    publish(message(1));
    const StatusCode reason = GENERATE(status::Bad_Timeout, status::Good_SubscriptionTransferred);
    pass(3s);
    publish_status(2, reason);
    CHECK(heard.statuses.back() == std::pair{reason, DeliveryMode::None});
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    CHECK(requester.count<DeleteSubscriptionsRequest>() == 0);
    reply(created(8));
    make_items();
    CHECK(requester.count<SetPublishingModeRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "A Subscription that is silent is looked after", "[client]")
{
    start();
    publish(message(1)); // keep-alives come every 10 s
    pass(15s);
    CHECK(requester.count<RepublishRequest>() == 0);
    pass(1s);
    SECTION("it lives")
    {
        refuse_republish(2);
        CHECK(requester.count<PublishRequest>() == 2);
        publish(message(2));
        CHECK(heard.take_values() == Values{1, 2});
    }
    SECTION("it is gone")
    {
        static_cast<void>(requester.take<RepublishRequest>());
        refuse(status::Bad_SubscriptionIdInvalid);
        CHECK(requester.count<CreateSubscriptionRequest>() == 1);
    }
    SECTION("nobody answers")
    {
        pass(10s);
        CHECK(requester.count<RepublishRequest>() >= 1);
    }
    CHECK(heard.gaps.empty());
}

namespace {

/// The server has given up on Publish requests that the client has renewed since.
void drop_old_publishes(PuppetRequester& requester)
{
    while (requester.count<PublishRequest>() > 2) {
        static_cast<void>(requester.take<PublishRequest>());
    }
}

} // namespace

TEST_CASE_METHOD(PuppetFixture, "A Subscription that is published no more is made anew", "[client]")
{
    start();
    const bool has_heard = GENERATE(true, false);
    if (has_heard) {
        publish(message(1)); // keep-alives come every 10 s
    }
    const std::uint32_t next = has_heard ? 2 : 1;
    for (int silences = 1; silences < 5; ++silences) {
        pass(16s);
        refuse_republish(next); // the server lives, and has no message
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
    }
    heard.statuses.clear();
    pass(16s);
    REQUIRE(requester.count<CreateSubscriptionRequest>() == 1);
    REQUIRE(heard.statuses.size() == 1);
    CHECK(heard.statuses[0].first == status::Bad_Timeout);
    CHECK(requester.take<DeleteSubscriptionsRequest>().subscription_ids ==
          Array<std::uint32_t>{server_id});
    reply(DeleteSubscriptionsResponse{});
    static_cast<void>(requester.take<CreateSubscriptionRequest>());
    reply(created(8));
    make_items();
    drop_old_publishes(requester);
    publish(message(1), 8);
    CHECK(heard.take_values() == (has_heard ? Values{1, 1} : Values{1}));
    CHECK(heard.gaps.size() == (has_heard ? 1 : 0));
}

TEST_CASE_METHOD(PuppetFixture,
                 "A silent Subscription of a server that only refuses is created again", "[client]")
{
    start();
    publish(message(1)); // keep-alives come every 10 s
    for (int silences = 1; silences <= 10; ++silences) {
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
        pass(16s);
        while (requester.count<RepublishRequest>() != 0) {
            static_cast<void>(requester.take<RepublishRequest>());
            refuse(status::Bad_TooManyOperations); // which says nothing of the message
            pass(1s);
        }
    }
    CHECK(requester.count<CreateSubscriptionRequest>() == 1);
}

TEST_CASE_METHOD(PuppetFixture, "A Subscription that publishes now and then is kept", "[client]")
{
    start();
    publish(message(1));
    for (std::uint32_t number = 2; number < 10; ++number) {
        for (int silences = 0; silences < 4; ++silences) {
            pass(16s);
            refuse_republish(number);
        }
        drop_old_publishes(requester);
        publish(message(number));
        CHECK(heard.take_values().back() == static_cast<std::int32_t>(number));
    }
    CHECK(requester.count<CreateSubscriptionRequest>() == 0);
    CHECK(heard.gaps.empty());
}

TEST_CASE_METHOD(PuppetFixture, "While nobody answers a Subscription is not given up", "[client]")
{
    start();
    publish(message(1));
    for (int seconds = 0; seconds < 300; seconds += 10) {
        pass(10s);
        CHECK(requester.count<CreateSubscriptionRequest>() == 0);
    }
}

} // namespace subscription_loss_test
