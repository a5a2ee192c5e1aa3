#include <catch2/catch.hpp>

#include <busbar/channel/open_gate.hpp>

#include "support/channel_pair.hpp"

namespace open_gate_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using Kind = channel::ChannelEvent::Kind;
using Bytes = std::vector<std::byte>;

namespace {

/// Says what a test wants, and keeps what it was asked and told.
class ScriptedGate final : public channel::OpenGate {
public:
    [[nodiscard]] Admission admit(bool is_renewal, Duration longest, TimePoint) override
    {
        asked += is_renewal ? "renew " : "open ";
        longest_wait = longest;
        return next;
    }
    void failed(TimePoint) override { asked += "failed "; }
    void worked() override { asked += "worked "; }

    Admission next;
    std::string asked;
    Duration longest_wait{};
};

/// Counts whose certificates were looked at, which is the first of what costs.
class CountingValidator final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain&,
                                         const crypto::ValidationContext&) override
    {
        ++count;
        return {};
    }

    int count{0};
};

const auto secured = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

/// A server's channel with a gate, its client, and a client's first messages as they were
/// overheard.
struct Gated {
    explicit Gated(channel::SecuritySetting security = secured, Way w = Way::InPlace)
        : way{w}, pair{security}, server{make(security)}
    {
    }
    explicit Gated(Way w) : Gated{secured, w} {}
    channel::ServerChannel make(channel::SecuritySetting security)
    {
        channel::ServerChannelConfig config;
        config.allowed = {security};
        config.channel_id = 77;
        return {config,
                {.random = &pair.random,
                 .wall_clock = &pair.wall_clock,
                 .log = &pair.log,
                 .validator = &validator,
                 .identity = &server_identity(),
                 .gate = &gate,
                 .worker = way == Way::Worker ? &worker : nullptr},
                pair.now};
    }
    /// Lets the client and the server talk until nothing moves.
    void run()
    {
        poll();
        bool moved = true;
        while (moved) {
            moved = carry(pair.client, server, pair.now, SIZE_MAX, [&] { poll(); });
            moved = carry(server, pair.client, pair.now, SIZE_MAX,
                          [&] {
                              while (auto event = pair.client.next_event()) {
                                  pair.client_events.push_back(*std::move(event));
                              }
                          }) ||
                    moved;
        }
    }
    void poll()
    {
        do {
            while (auto event = server.next_event()) {
                events.push_back(*std::move(event));
            }
        } while (worker.finish(server, pair.now));
    }
    void advance(Duration time)
    {
        pair.now += time;
        server.handle_deadline(pair.now);
        run();
    }
    void send()
    {
        REQUIRE(pair.client.send([](binary::Writer& w) { w.number(7U); }));
    }
    [[nodiscard]] bool has(Kind kind) const { return ChannelPair::find(events, kind) != nullptr; }

    Way way;
    ScriptedGate gate;
    HandWorker worker;
    CountingValidator validator;
    ChannelPair pair;
    channel::ServerChannel server;
    std::vector<channel::ChannelEvent> events;
};

} // namespace

TEST_CASE("a channel is opened when the gate lets it, and works with its first message",
          "[channel][gate]")
{
    Gated gated{GENERATE(Way::InPlace, Way::Worker)};
    gated.run();
    CHECK(gated.has(Kind::Opened));
    CHECK(gated.gate.asked == "open ");
    CHECK(gated.gate.longest_wait == 10s);
    gated.send();
    gated.send();
    gated.run();
    CHECK(gated.gate.asked == "open worked ");
    CHECK(gated.has(Kind::Message));
    gated.pair.client.close();
    gated.run();
    CHECK(gated.gate.asked == "open worked ");
}

TEST_CASE("policy None never sees the gate", "[channel][gate]")
{
    Gated gated{channel::SecuritySetting{}};
    gated.gate.next.is_admitted = false;
    gated.run();
    gated.send();
    gated.run();
    CHECK(gated.has(Kind::Message));
    CHECK(gated.gate.asked.empty());
}

TEST_CASE("what is not admitted is told so before any work", "[channel][gate]")
{
    Gated gated;
    gated.gate.next.is_admitted = false;
    SECTION("and the log, once") {}
    SECTION("and the log not again")
    {
        gated.gate.next.is_known = true;
    }
    gated.run();
    CHECK(gated.server.is_closed());
    CHECK(gated.validator.count == 0);
    CHECK(gated.gate.asked == "open ");
    REQUIRE(gated.pair.client_events.size() == 1);
    CHECK(gated.pair.client_events[0].status == status::Bad_TcpServerTooBusy);
    CHECK((gated.pair.log.text.find("Bad_TcpServerTooBusy") == std::string::npos) ==
          gated.gate.next.is_known);
}

TEST_CASE("an input waits for its turn", "[channel][gate]")
{
    Gated gated{GENERATE(Way::InPlace, Way::Worker)};
    gated.gate.next.wait = 3s;
    gated.run();
    CHECK(gated.server.is_waiting());
    CHECK(gated.server.next_deadline() == gated.pair.now + 3s);
    CHECK(gated.validator.count == 0);
    SECTION("and is worked on then")
    {
        gated.advance(2'999ms);
        CHECK(gated.validator.count == 0);
        gated.advance(1ms);
        CHECK(gated.has(Kind::Opened));
        CHECK_FALSE(gated.server.is_waiting());
        CHECK(gated.gate.asked == "open "); // once
        gated.send();
        gated.run();
        CHECK(gated.gate.asked == "open worked ");
    }
    SECTION("also what is fed meanwhile")
    {
        static_cast<void>(gated.server.feed(Bytes(8, std::byte{0x58}), gated.pair.now + 1s));
        CHECK_FALSE(gated.server.next_event());
        gated.advance(3s);
        CHECK(gated.has(Kind::Opened));
        CHECK(gated.server.is_closed()); // that was no message
        CHECK(gated.gate.asked == "open failed ");
    }
    SECTION("without a deadline being handled, if something is fed late")
    {
        gated.pair.now += 3s;
        static_cast<void>(gated.server.feed({}, gated.pair.now));
        gated.run();
        CHECK(gated.has(Kind::Opened));
    }
    SECTION("and is dropped with the channel, which has cost nothing")
    {
        gated.server.close(status::Bad_Shutdown, "over");
        CHECK_FALSE(gated.server.is_waiting());
        CHECK(gated.server.next_deadline() == no_deadline);
        gated.advance(3s);
        CHECK(gated.gate.asked == "open ");
    }
    SECTION("or with the time for the handshake")
    {
        gated.gate.next.wait = 3s;
        gated.pair.now += 10s;
        gated.server.handle_deadline(gated.pair.now);
        CHECK(gated.server.is_closed());
        CHECK(gated.validator.count == 0);
    }
}

TEST_CASE("the gate hears of work for nothing", "[channel][gate]")
{
    auto gated = std::make_unique<Gated>(GENERATE(Way::InPlace, Way::Worker));
    carry(gated->pair.client, gated->server, gated->pair.now, SIZE_MAX, [&] { gated->poll(); });
    carry(gated->server, gated->pair.client, gated->pair.now);
    while (gated->pair.client.next_event()) {
    }
    Bytes open = take_output(gated->pair.client);
    SECTION("a signature that is not right")
    {
        open.back() ^= std::byte{1};
        REQUIRE(gated->server.feed(open, gated->pair.now));
        gated->poll();
        CHECK(gated->server.is_closed());
        CHECK(gated->gate.asked == "open failed ");
    }
    SECTION("a header that is not right costs nothing")
    {
        open[8] ^= std::byte{1}; // the SecureChannelId
        REQUIRE(gated->server.feed(open, gated->pair.now));
        gated->poll();
        CHECK(gated->server.is_closed());
        CHECK(gated->gate.asked.empty());
    }
    SECTION("a request that was overheard opens a channel, which then ends")
    {
        REQUIRE(gated->server.feed(open, gated->pair.now));
        gated->poll();
        CHECK(gated->has(Kind::Opened));
        CHECK(gated->gate.asked == "open ");
        SECTION("by itself")
        {
            gated->server.close(status::Bad_Timeout, "no session");
        }
        SECTION("with its connection")
        {
            gated->server = gated->make(secured); // the old one goes
        }
        SECTION("with a message that takes keys which the sender has not")
        {
            Bytes message(64);
            const auto header = std::as_bytes(std::span{"MSGF", 4});
            std::copy(header.begin(), header.end(), message.begin());
            message[4] = std::byte{64};
            message[8] = std::byte{77};
            message[12] = std::byte{1};
            REQUIRE(gated->server.feed(message, gated->pair.now));
            gated->poll();
        }
        CHECK(gated->gate.asked == "open failed ");
    }
    SECTION("once, whatever all was for nothing on a channel")
    {
        REQUIRE(gated->server.feed(open, gated->pair.now));
        gated->poll();
        Bytes renewal = open;
        renewal[8] = std::byte{77}; // the channel's id, which the signature covers
        REQUIRE(gated->server.feed(renewal, gated->pair.now));
        gated->poll();
        CHECK(gated->server.is_closed());
        gated->server = gated->make(secured);
        CHECK(gated->gate.asked == "open renew failed ");
    }
}

TEST_CASE("a renewal asks for itself", "[channel][gate]")
{
    Gated gated{GENERATE(Way::InPlace, Way::Worker)};
    gated.run();
    gated.send();
    gated.run();
    gated.gate.asked.clear();
    gated.gate.next.wait = 2s;
    gated.pair.now += 46s;
    gated.pair.client.handle_deadline(gated.pair.now);
    gated.run();
    CHECK(gated.server.is_waiting());
    CHECK(gated.server.next_deadline() == gated.pair.now + 2s);
    CHECK(gated.gate.longest_wait == Duration::max());
    SECTION("goes on, and what came behind it in its order")
    {
        gated.send();
        gated.run();
        gated.events.clear();
        gated.advance(2s);
        REQUIRE(gated.events.size() == 2);
        CHECK(gated.events[0].kind == Kind::Renewed);
        CHECK(gated.events[1].kind == Kind::Message);
        CHECK(gated.gate.asked == "renew ");
    }
    SECTION("does not outlive its token")
    {
        gated.pair.now += 1h;
        gated.server.handle_deadline(gated.pair.now);
        CHECK(gated.server.is_closed());
    }
}

} // namespace open_gate_test
