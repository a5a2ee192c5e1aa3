#include <catch2/catch.hpp>

#include "client/subscription/message_stream.hpp"

namespace message_stream_test {

using namespace busbar;
using client::detail::MessageStream;
using namespace std::chrono_literals;

namespace {

constexpr DateTime first = DateTime::from_unix_seconds(1'000);
constexpr DateTime second = DateTime::from_unix_seconds(2'000);

TimePoint at(Duration time)
{
    return TimePoint{} + time;
}

/// One that lives and has heard of its first message.
MessageStream stream()
{
    MessageStream messages{3};
    messages.keep_alive_interval = 10s;
    messages.heard(first, at(100s));
    return messages;
}

} // namespace

TEST_CASE("a Subscription is silent after one and a half keep-alive intervals", "[message_stream]")
{
    MessageStream messages = stream();
    CHECK(messages.silent_at == at(116s));
    CHECK_FALSE(messages.needs_republish());
    CHECK(messages.fall_silent(at(116s)) == 1);
    CHECK(messages.needs_republish()); // something may have been lost
    CHECK(messages.fall_silent(at(132s)) == 2);
    CHECK(messages.silent_at == at(148s));
    CHECK(messages.heard_time == first);
    messages.heard(second, at(140s));
    CHECK(messages.fall_silent(at(156s)) == 1);
    messages.interrupt();
    CHECK(messages.silent_at == no_deadline);
}

TEST_CASE("a loss has the reason that it began with", "[message_stream]")
{
    MessageStream messages = stream();
    messages.complete_until = first;
    messages.lose(status::Bad_MessageNotAvailable);
    messages.complete_until = second;
    messages.lose(status::Bad_Timeout);
    REQUIRE(messages.loss);
    CHECK(messages.loss->reason == status::Bad_MessageNotAvailable);
    CHECK(messages.loss->from == first);
    messages.restart();
    CHECK(messages.loss);
    CHECK(messages.complete_until == second);
    CHECK(messages.sequence.next() == 1);
}

TEST_CASE("catching up ends when nothing is missing", "[message_stream]")
{
    MessageStream messages = stream();
    messages.catch_up(at(200s));
    CHECK(messages.needs_republish());
    CHECK(messages.is_catching_up);
    messages.is_probing = false; // the server has nothing more
    CHECK_FALSE(messages.needs_republish());
    CHECK_FALSE(messages.is_catching_up);
    CHECK(messages.sequence.expect_before(3));
    CHECK(messages.needs_republish()); // numbers 1 and 2
    CHECK_FALSE(messages.is_catching_up);
}

TEST_CASE("one that is made anew has nothing to catch up with", "[message_stream]")
{
    MessageStream messages = stream();
    messages.catch_up(at(110s));
    CHECK(messages.is_catching_up);
    messages.restart();
    CHECK_FALSE(messages.is_catching_up);
    CHECK_FALSE(messages.needs_republish());
}

TEST_CASE("a server that always has one more message is not probed for ever", "[message_stream]")
{
    MessageStream messages = stream();
    messages.catch_up(at(200s));
    messages.republished();
    messages.republished();
    CHECK(messages.is_probing);
    messages.republished();
    CHECK_FALSE(messages.is_probing);
    messages.begin_session();
    CHECK(messages.probe_count == 0);
}

} // namespace message_stream_test
