#include <catch2/catch.hpp>

#include "support/channel_pair.hpp"

namespace renewal_test {

using namespace busbar;
using namespace busbar::test;
using Kind = channel::ChannelEvent::Kind;
using Bytes = std::vector<std::byte>;
using std::chrono::seconds;

namespace {

channel::SecuritySetting secured(MessageSecurityMode mode = MessageSecurityMode::SignAndEncrypt)
{
    return setting("Basic256Sha256", mode);
}

constexpr auto write_number = [](binary::Writer& writer) { writer.number(std::uint32_t{7}); };

/// The message that the client sends, kept from the server.
Bytes message_of(ChannelPair& pair)
{
    REQUIRE(pair.client.send(write_number));
    return take_output(pair.client);
}

void feed(ChannelPair& pair, const Bytes& bytes)
{
    static_cast<void>(pair.server.feed(bytes, pair.now));
    while (auto event = pair.server.next_event()) {
        pair.server_events.push_back(*std::move(event));
    }
}

std::size_t messages(const std::vector<channel::ChannelEvent>& events)
{
    return static_cast<std::size_t>(std::count_if(
        events.begin(), events.end(), [](const auto& e) { return e.kind == Kind::Message; }));
}

StatusCode reason(const ChannelPair& pair)
{
    const auto* closed = ChannelPair::find(pair.server_events, Kind::Closed);
    return closed == nullptr ? StatusCode{} : closed->status;
}

/// A channel 46 of its 60 seconds old whose client asked for a new token and was answered; the
/// answer is still on its way.
struct InRenewal {
    explicit InRenewal(Way way, const channel::SecuritySetting& security = secured())
        : pair{security, {}, {}, way}
    {
        pair.run();
        pair.now += seconds{46};
        pair.client.handle_deadline(pair.now);
        pair.run_to_server();
        REQUIRE(ChannelPair::find(pair.server_events, Kind::Renewed) != nullptr);
    }

    ChannelPair pair;
};

} // namespace

TEST_CASE("inside the overlap the old and the new token are taken", "[channel][renewal]")
{
    const Way way = GENERATE(Way::InPlace, Way::Worker);
    for (const auto& security :
         {channel::SecuritySetting{}, secured(), secured(MessageSecurityMode::Sign)}) {
        InRenewal renewal{way, security};
        ChannelPair& pair = renewal.pair;
        feed(pair, message_of(pair)); // the client does not have the new one yet
        CHECK(messages(pair.server_events) == 1);
        pair.run_to_client();
        feed(pair, message_of(pair));
        CHECK(messages(pair.server_events) == 2);
        CHECK(pair.server.is_open());
    }
}

TEST_CASE("after the first message under the new token the old one is void", "[channel][renewal]")
{
    InRenewal renewal{GENERATE(Way::InPlace, Way::Worker)};
    ChannelPair& pair = renewal.pair;
    const Bytes old = message_of(pair);
    feed(pair, old);
    pair.run_to_client();
    feed(pair, message_of(pair));
    CHECK(messages(pair.server_events) == 2);
    feed(pair, old);
    CHECK(reason(pair) == status::Bad_SecureChannelTokenUnknown);
}

TEST_CASE("the old token is void so even if the server went over to the new one by itself",
          "[channel][renewal]")
{
    InRenewal renewal{GENERATE(Way::InPlace, Way::Worker)};
    ChannelPair& pair = renewal.pair;
    const Bytes old = message_of(pair);
    feed(pair, old);
    pair.run_to_client();
    pair.now = TimePoint{} + seconds{60};
    pair.server.handle_deadline(pair.now);
    feed(pair, message_of(pair));
    CHECK(messages(pair.server_events) == 2);
    feed(pair, old); // which the server would take until 75 seconds from a silent client
    CHECK(reason(pair) == status::Bad_SecureChannelTokenUnknown);
}

TEST_CASE("a client that stays silent gets its responses under the new token when the old ended",
          "[channel][renewal]")
{
    InRenewal renewal{GENERATE(Way::InPlace, Way::Worker)};
    ChannelPair& pair = renewal.pair;
    pair.run_to_client();
    CHECK(pair.server.next_deadline() == TimePoint{} + seconds{60});
    pair.now = TimePoint{} + seconds{60};
    pair.server.handle_deadline(pair.now);
    CHECK(pair.server.is_open());
    pair.now = TimePoint{} + seconds{80}; // the client takes the old token for 75 seconds only
    REQUIRE(pair.server.send(3, write_number));
    pair.run_to_client();
    CHECK(messages(pair.client_events) == 1);
    feed(pair, message_of(pair));
    CHECK(messages(pair.server_events) == 1);
}

TEST_CASE("an expired token is refused even before the deadline was handled", "[channel][renewal]")
{
    ChannelPair pair{secured()};
    pair.run();
    const Bytes first = message_of(pair);
    const Bytes second = message_of(pair);
    pair.now += seconds{74};
    feed(pair, first);
    CHECK(messages(pair.server_events) == 1);
    pair.now += seconds{1};
    feed(pair, second);
    CHECK(reason(pair) == status::Bad_SecureChannelTokenUnknown);
}

TEST_CASE("a late deadline ends what is over", "[channel][renewal]")
{
    InRenewal renewal{GENERATE(Way::InPlace, Way::Worker)};
    renewal.pair.server.handle_deadline(TimePoint{} + seconds{300});
    CHECK(renewal.pair.server.is_closed());
    CHECK(renewal.pair.client.next_deadline() == TimePoint{} + seconds{75});
    renewal.pair.client.handle_deadline(TimePoint{} + seconds{75});
    CHECK(renewal.pair.client.is_closed());
}

TEST_CASE("a token of another channel is no token", "[channel][renewal]")
{
    ChannelPair one{secured()};
    ChannelPair two{secured()};
    Bytes drawn(5); // so that the nonces, and with them the keys, are other ones
    REQUIRE(two.random.fill(drawn));
    one.run();
    two.run();
    feed(two, message_of(one));
    CHECK(reason(two) == status::Bad_SecurityChecksFailed);
    ChannelPair three{secured()};
    three.run();
    Bytes unknown = message_of(three);
    unknown[12] = std::byte{9}; // TokenId
    feed(three, unknown);
    CHECK(reason(three) == status::Bad_SecureChannelTokenUnknown);
}

TEST_CASE("a lifetime is brought into the server's range", "[channel][renewal]")
{
    channel::ClientChannelConfig config;
    for (const auto& [asked, granted] :
         {std::pair{1, 10}, std::pair{60, 60}, std::pair{1'000'000, 3'600}}) {
        config.requested_lifetime = seconds{asked};
        ChannelPair pair;
        pair.client = channel::ClientChannel{config,
                                             {.random = &pair.random,
                                              .wall_clock = &pair.wall_clock,
                                              .log = &pair.log,
                                              .validator = &pair.validator},
                                             pair.now};
        pair.run();
        REQUIRE(pair.client.is_open());
        CHECK(pair.client.next_deadline() == pair.now + Duration{seconds{granted}} * 3 / 4);
    }
}

} // namespace renewal_test
