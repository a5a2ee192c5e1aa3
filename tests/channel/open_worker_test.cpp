#include <catch2/catch.hpp>

#include <busbar/channel/open_gate.hpp>

#include "support/channel_pair.hpp"

namespace open_worker_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using Kind = channel::ChannelEvent::Kind;
using WorkKind = channel::OpenWork::Kind;
using Bytes = std::vector<std::byte>;

namespace {

const auto secured = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

/// Lets everything through, and keeps what it was told.
class OpenDoor final : public channel::OpenGate {
public:
    [[nodiscard]] Admission admit(bool, Duration, TimePoint) override { return {}; }
    void failed(TimePoint) override { told += "failed "; }
    void worked() override { told += "worked "; }

    std::string told;
};

/// A server's channel whose worker does nothing by itself, and its client.
struct Worked {
    Worked() : server{make()}
    {
        talk();
        REQUIRE(worker.work != nullptr);
    }
    channel::ServerChannel make()
    {
        channel::ServerChannelConfig config;
        config.allowed = {secured};
        config.channel_id = 77;
        return {config,
                {.random = &pair.random,
                 .wall_clock = &pair.wall_clock,
                 .log = &pair.log,
                 .validator = &pair.validator,
                 .identity = &identity,
                 .gate = &gate,
                 .worker = &worker},
                pair.now};
    }
    void talk()
    {
        poll();
        bool moved = true;
        while (moved) {
            moved = carry(pair.client, server, pair.now, SIZE_MAX, [&] { poll(); });
            moved = carry(server, pair.client, pair.now, SIZE_MAX, [&] { poll_client(); }) || moved;
        }
    }
    void poll()
    {
        while (auto event = server.next_event()) {
            events.push_back(*std::move(event));
        }
    }
    void poll_client()
    {
        while (auto event = pair.client.next_event()) {
            pair.client_events.push_back(*std::move(event));
        }
    }
    /// One piece of work.
    void finish()
    {
        REQUIRE(worker.finish(server, pair.now));
        talk();
    }
    void fail(StatusCode status)
    {
        worker.work = nullptr;
        server.work_done(status, pair.now);
        talk();
    }
    void open()
    {
        finish();
        finish();
        REQUIRE(server.is_open());
        send();
        talk();
        REQUIRE(gate.told == "worked ");
        events.clear();
        pair.client_events.clear();
        gate.told.clear();
    }
    /// The client asks for another token.
    void renew()
    {
        pair.now += 46s;
        pair.client.handle_deadline(pair.now);
        talk();
        REQUIRE(worker.work != nullptr);
    }
    void send()
    {
        REQUIRE(pair.client.send([](binary::Writer& w) { w.number(7U); }));
    }
    void respond(std::uint32_t id)
    {
        REQUIRE(server.send(id, [](binary::Writer& w) { w.number(7U); }));
    }
    [[nodiscard]] bool has(Kind kind) const { return ChannelPair::find(events, kind) != nullptr; }
    [[nodiscard]] StatusCode told() const
    {
        const auto* closed = ChannelPair::find(pair.client_events, Kind::Closed);
        return closed != nullptr ? closed->status : StatusCode{};
    }

    OpenDoor gate;
    HandWorker worker;
    channel::ApplicationIdentity identity{server_identity()};
    ChannelPair pair{secured};
    channel::ServerChannel server;
    std::vector<channel::ChannelEvent> events;
};

std::size_t count(const std::vector<channel::ChannelEvent>& events, Kind kind)
{
    return static_cast<std::size_t>(
        std::count_if(events.begin(), events.end(), [&](const auto& e) { return e.kind == kind; }));
}

} // namespace

TEST_CASE_METHOD(Worked, "a worker opens a channel in two pieces", "[channel][worker]")
{
    CHECK(server.is_waiting());
    CHECK(worker.work->kind() == WorkKind::Request);
    CHECK(events.empty());
    CHECK(server.next_deadline() == pair.now + 10s);
    finish();
    CHECK(server.is_waiting());
    CHECK(worker.work->kind() == WorkKind::Answer);
    CHECK_FALSE(server.is_open());
    CHECK(server.output().empty());
    finish();
    CHECK_FALSE(server.is_waiting());
    CHECK(has(Kind::Opened));
    CHECK(pair.client.is_open());
    send();
    talk();
    CHECK(has(Kind::Message));
    CHECK(gate.told == "worked ");
    CHECK(worker.started == 2);
    CHECK(worker.dropped == 0);
}

TEST_CASE_METHOD(Worked, "what comes behind the request waits, in its order", "[channel][worker]")
{
    SECTION("and is worked on then")
    {
        static_cast<void>(server.feed(Bytes(8, std::byte{0x58}), pair.now));
        CHECK_FALSE(server.next_event());
        CHECK(server.is_waiting());
        finish();
        CHECK_FALSE(server.is_closed());
        finish();
        REQUIRE(events.size() == 2);
        CHECK(events[0].kind == Kind::Opened);
        CHECK(events[1].kind == Kind::Closed); // that was no message
        CHECK(gate.told == "failed ");
    }
    SECTION("with a renewal, too")
    {
        open();
        renew();
        CHECK(worker.work->kind() == WorkKind::Renewal);
        send();
        send();
        talk();
        CHECK(events.empty());
        finish();
        CHECK(worker.work->kind() == WorkKind::Renewal);
        CHECK(events.empty());
        finish();
        REQUIRE(events.size() == 3);
        CHECK(events[0].kind == Kind::Renewed);
        CHECK(events[1].kind == Kind::Message);
        CHECK(events[2].kind == Kind::Message);
    }
}

TEST_CASE_METHOD(Worked, "responses go on while a renewal is with the worker", "[channel][worker]")
{
    open();
    renew();
    respond(1); // before the answer has its sequence number
    talk();
    CHECK(count(pair.client_events, Kind::Message) == 1);
    finish();
    respond(2);
    respond(3);
    CHECK(server.output().empty()); // they have later numbers than the answer
    CHECK(server.unsent_size() != 0);
    talk();
    CHECK(count(pair.client_events, Kind::Message) == 1);
    SECTION("and follow its answer")
    {
        finish();
        REQUIRE(pair.client_events.size() == 4);
        CHECK(pair.client_events[1].kind == Kind::Renewed);
        CHECK(pair.client_events[2].request_id == 2);
        CHECK(pair.client_events[3].request_id == 3);
        CHECK(server.unsent_size() == 0);
        send();
        talk();
        CHECK(has(Kind::Message));
    }
    SECTION("one that fails leaves nothing behind")
    {
        const std::size_t size = server.unsent_size();
        CHECK_FALSE(server.send(4, [](binary::Writer& w) {
            w.number(1U);
            w.fail(status::Bad_EncodingError);
        }));
        CHECK(server.unsent_size() == size);
        finish();
        CHECK(count(pair.client_events, Kind::Message) == 3);
        CHECK(pair.client.is_open());
    }
    SECTION("and are not sent if the channel ends: an Error message is")
    {
        server.close(status::Bad_Shutdown, "over");
        talk();
        CHECK(told() == status::Bad_Shutdown);
        CHECK(count(pair.client_events, Kind::Message) == 1);
        CHECK(worker.dropped == 1);
    }
    SECTION("also behind what the peer has not taken yet")
    {
        finish();
        send(); // so that the server takes the new token, too
        talk();
        renew();
        respond(4);
        finish();
        respond(5);
        server.consume(0);
        finish();
        CHECK(pair.client.is_open());
        CHECK(count(pair.client_events, Kind::Renewed) == 2);
        CHECK(count(pair.client_events, Kind::Message) == 5);
    }
}

TEST_CASE_METHOD(Worked, "work that is done too late is nobody's", "[channel][worker]")
{
    std::shared_ptr<channel::OpenWork> late;
    const auto finish_late = [&] {
        REQUIRE(server.is_closed());
        CHECK(worker.dropped == 1);
        late->run();
        server.work_done({}, pair.now);
        poll();
        CHECK(count(events, Kind::Closed) == 1);
        CHECK(count(events, Kind::Opened) + count(events, Kind::Renewed) == 0);
    };
    SECTION("the connection was closed")
    {
        late = worker.work;
        server.close(status::Bad_Shutdown, "over");
        finish_late();
        CHECK(gate.told == "failed ");
    }
    SECTION("the time for the handshake is over, which is not the peer's failure")
    {
        late = worker.work;
        pair.now += 10s;
        server.handle_deadline(pair.now);
        finish_late();
        CHECK(events.back().status == status::Bad_Timeout);
        CHECK(gate.told.empty());
    }
    SECTION("so it is while the answer is sealed")
    {
        finish();
        late = worker.work;
        pair.now += 10s;
        server.handle_deadline(pair.now);
        finish_late();
        CHECK(events.back().status == status::Bad_Timeout);
    }
    SECTION("the token has expired")
    {
        open();
        renew();
        SECTION("before the request was read") {}
        SECTION("before the answer was sealed")
        {
            finish();
            respond(1);
        }
        late = worker.work;
        pair.now += 29s;
        server.handle_deadline(pair.now);
        finish_late();
        CHECK(events.back().status == status::Bad_SecureChannelTokenUnknown);
        talk();
        CHECK(told().is_bad());
    }
    SECTION("the channel is not there any more")
    {
        late = worker.work;
        server = make();
        CHECK(worker.dropped == 1);
        late->run();
        server.work_done({}, pair.now); // a stray one does nothing
        CHECK_FALSE(server.is_closed());
    }
}

TEST_CASE_METHOD(Worked, "what the worker does not do ends the channel", "[channel][worker]")
{
    SECTION("no room for the request")
    {
        worker.is_full = true;
        worker.drop();
        server = make();
        pair.client = channel::ClientChannel{[] {
                                                 channel::ClientChannelConfig config;
                                                 config.endpoint_url = "opc.tcp://localhost:4840";
                                                 config.security = secured;
                                                 config.server_certificate =
                                                     server_identity().certificates.front();
                                                 return config;
                                             }(),
                                             {.random = &pair.random,
                                              .wall_clock = &pair.wall_clock,
                                              .log = &pair.log,
                                              .validator = &pair.validator,
                                              .identity = &client_identity()},
                                             pair.now};
        gate.told.clear();
        talk();
        CHECK(told() == status::Bad_TcpServerTooBusy);
    }
    SECTION("no room for the answer")
    {
        worker.is_full = true;
        finish();
        CHECK(told() == status::Bad_TcpServerTooBusy);
    }
    SECTION("others go first")
    {
        fail(status::Bad_TcpServerTooBusy);
        CHECK(told() == status::Bad_TcpServerTooBusy);
        CHECK(pair.log.text.find("Bad_TcpServerTooBusy") != std::string::npos);
    }
    SECTION("no memory")
    {
        fail(status::Bad_OutOfMemory);
        CHECK(told() == status::Bad_OutOfMemory);
    }
    SECTION("no memory for the answer to a renewal")
    {
        open();
        renew();
        finish();
        respond(1);
        fail(status::Bad_OutOfMemory);
        CHECK(told() == status::Bad_OutOfMemory);
        CHECK(server.unsent_size() == 0);
    }
    CHECK(server.is_closed());
    CHECK(gate.told.empty()); // none of it the peer's failure
}

TEST_CASE_METHOD(Worked, "work goes on with the key that it was begun with", "[channel][worker]")
{
    identity = client_identity();
    finish();
    identity = server_identity();
    SECTION("the answer, too")
    {
        identity = client_identity();
    }
    finish();
    CHECK(pair.client.is_open());
}

} // namespace open_worker_test
