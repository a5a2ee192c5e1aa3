#include <catch2/catch.hpp>

#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include <busbar/server/running_server.hpp>

#include "session_use.hpp"
#include "support/job_list.hpp"
#include "support/server_fixture.hpp"

namespace channel_worker_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;

namespace {

const auto secured = setting("Basic256Sha256", MessageSecurityMode::SignAndEncrypt);

server::ServerConfig unrationed()
{
    server::ServerConfig config = ServerFixture::insecure_config();
    config.limits.channel_interval = 0s;
    config.limits.failed_channel_interval = 0s;
    return config;
}

/// A server whose channels are opened by a worker, which waits for the test.
struct Worked {
    /// A client that has sent its OpenSecureChannel.
    TestClient connect(std::string_view address = "192.0.2.1")
    {
        return fixture.connect(secured, client_identity(), address);
    }
    /// Does one job, and gives what came of it to the server.
    bool work_once()
    {
        if (!worker.work_once()) {
            return false;
        }
        fixture.server.handle_completions(fixture.now);
        return true;
    }
    /// One whose channel is open.
    TestClient open(std::string_view address = "192.0.2.1")
    {
        TestClient client = connect(address);
        finish(client);
        REQUIRE(client.channel.is_open());
        return client;
    }
    void finish(TestClient& client)
    {
        while (work_once()) {
            client.run();
        }
    }
    /// Its client asks for another token.
    void renew(TestClient& client)
    {
        fixture.now = client.channel.next_deadline();
        client.channel.handle_deadline(fixture.now);
        client.run();
    }
    [[nodiscard]] std::vector<std::uint64_t> changed()
    {
        std::vector<std::uint64_t> ids;
        while (const auto id = fixture.server.next_changed()) {
            ids.push_back(*id);
        }
        return ids;
    }
    [[nodiscard]] bool has_logged(std::string_view text) const
    {
        return fixture.log.text.find(text) != std::string::npos;
    }

    SilentWaker waker;
    JobList worker;
    ServerFixture fixture{waker, &worker, unrationed()};
};

} // namespace

TEST_CASE_METHOD(Worked, "channels are opened by a worker while others are served")
{
    auto other = fixture.log_in(); // policy None: there is nothing to do
    CHECK(worker.jobs.empty());
    auto client = connect();
    CHECK(worker.jobs.size() == 1);
    CHECK(client.connection.has_enough());
    CHECK_FALSE(client.channel.is_open());
    CHECK(use(other) == status::Good);
    static_cast<void>(changed());

    REQUIRE(work_once());
    CHECK(changed() == std::vector{client.connection.id()});
    client.run();
    CHECK_FALSE(client.channel.is_open());
    CHECK(worker.jobs.size() == 1);
    CHECK(use(other) == status::Good);
    REQUIRE(work_once());
    CHECK(changed() == std::vector{client.connection.id()});
    CHECK_FALSE(client.connection.has_enough());
    client.run();
    CHECK(client.channel.is_open());
    REQUIRE(client.open_session() == status::Good);

    renew(client);
    CHECK(client.connection.has_enough());
    const auto created = client.send(CreateSessionRequest{});
    CHECK(client.take<CreateSessionResponse>(created).error() == status::Bad_WouldBlock);
    finish(client);
    CHECK(client.take<CreateSessionResponse>(created).error() != status::Bad_WouldBlock);
    CHECK(use(client) == status::Good);
}

TEST_CASE("without a way back from the worker channels are opened in place")
{
    JobList worker;
    FixedWallClock clock;
    SeededRandom random;
    LogBook log;
    crypto::InsecureAcceptAnyCertificate validator;
    PlainUsers users;
    auto server =
        server::Server::create(ServerFixture::secure_config(), {.random = &random,
                                                                .wall_clock = &clock,
                                                                .log = &log,
                                                                .validator = &validator,
                                                                .users = &users,
                                                                .channel_worker = &worker})
            .value();
    TimePoint now{};
    TestClient client{server.connect("192.0.2.1", now).value(), secured,
                      channel::ChannelEnvironment{.random = &random,
                                                  .wall_clock = &clock,
                                                  .log = &log,
                                                  .validator = &validator,
                                                  .identity = &client_identity()},
                      now};
    CHECK(client.channel.is_open());
    CHECK(worker.jobs.empty());
}

TEST_CASE_METHOD(Worked, "channels of several connections are opened in whatever order")
{
    auto first = connect("192.0.2.1");
    auto second = connect("192.0.2.2");
    auto third = connect("192.0.2.3");
    REQUIRE(work_once()); // the first one's request; its answer goes before others' requests
    REQUIRE(work_once());
    first.run();
    CHECK(first.channel.is_open());
    std::swap(worker.jobs[0], worker.jobs[1]); // which are alike
    std::optional<TestClient> gone{std::move(second)};
    gone.reset();
    finish(third);
    CHECK(third.channel.is_open());
    CHECK(use(first) != status::Bad_WouldBlock);
    CHECK(worker.jobs.empty());
}

TEST_CASE_METHOD(Worked, "work for a connection that has gone is nobody's")
{
    std::optional<TestClient> client{connect()};
    SECTION("with the request")
    {
        client.reset();
        REQUIRE(worker.jobs.size() == 1);
        REQUIRE(work_once());
        CHECK(worker.jobs.empty()); // no answer
    }
    SECTION("with the answer")
    {
        REQUIRE(work_once());
        client.reset();
        REQUIRE(work_once());
    }
    SECTION("when it was done already")
    {
        REQUIRE(worker.work_once());
        client.reset();
        fixture.server.handle_completions(fixture.now);
        CHECK(worker.jobs.empty());
    }
    SECTION("for its handshake has taken too long")
    {
        fixture.advance(10s, *client);
        CHECK(client->is_closed());
        CHECK(has_logged("Bad_Timeout"));
        REQUIRE(work_once());
        CHECK(worker.jobs.empty());
    }
    CHECK(fixture.log_in().channel.is_open());
}

TEST_CASE_METHOD(Worked, "a server stops while its worker has channels")
{
    auto client = connect();
    fixture.server.begin_shutdown(fixture.now, "over");
    fixture.advance(fixture.server.config().shutdown_delay + 1s, client);
    CHECK(client.is_closed());
    REQUIRE(work_once());
    CHECK(worker.jobs.empty());
}

TEST_CASE("work that is done after its server has gone is nobody's")
{
    SilentWaker waker;
    JobList worker;
    {
        ServerFixture fixture{waker, &worker};
        auto client = fixture.connect(secured);
        REQUIRE(worker.jobs.size() == 1);
    }
    CHECK(worker.work_once());
    CHECK(worker.jobs.empty());
}

TEST_CASE_METHOD(Worked, "a worker without room is told of as a ration is")
{
    worker.most = 0;
    auto client = connect();
    CHECK(client.is_closed());
    CHECK(has_logged("more than the worker has room for"));
    CHECK(has_logged("Bad_TcpServerTooBusy"));
    worker.most = 1;
    CHECK(open().channel.is_open());
}

TEST_CASE_METHOD(Worked, "a renewal goes before strangers, and takes their place")
{
    auto good = open();
    REQUIRE(good.open_session() == status::Good);
    worker.most = 4;
    fixture.now = good.channel.next_deadline();
    static_cast<void>(changed());
    std::deque<TestClient> strangers;
    for (int i = 0; i < 4; ++i) {
        strangers.push_back(connect("192.0.2." + std::to_string(50 + i)));
    }
    auto refused = connect("192.0.2.60"); // the newest of those who have one each
    CHECK(refused.is_closed());
    renew(good);
    CHECK_FALSE(good.is_closed());
    CHECK(strangers[3].is_closed());
    CHECK_FALSE(strangers[2].is_closed());
    const auto ids = changed();
    CHECK(std::find(ids.begin(), ids.end(), strangers[3].connection.id()) != ids.end());
    REQUIRE(work_once());
    REQUIRE(work_once());
    good.run();
    CHECK(use(good) == status::Good); // which takes the new token
    CHECK_FALSE(strangers[0].channel.is_open());
    finish(strangers[0]);
    CHECK(strangers[0].channel.is_open());
}

TEST_CASE_METHOD(Worked, "of strangers those go who have most waiting")
{
    worker.most = 4;
    std::deque<TestClient> greedy;
    for (int i = 0; i < 4; ++i) {
        greedy.push_back(connect("192.0.2.50"));
    }
    auto modest = connect("192.0.2.51");
    CHECK_FALSE(modest.is_closed());
    CHECK(greedy[3].is_closed());
    REQUIRE(work_once());
    REQUIRE(work_once());
    modest.run();
    CHECK(modest.channel.is_open());
    CHECK_FALSE(greedy[0].channel.is_open());
}

TEST_CASE_METHOD(Worked, "who hangs up gives his place away")
{
    worker.most = 2;
    {
        auto one = connect("192.0.2.50");
        auto two = connect("192.0.2.51");
    }
    REQUIRE(worker.jobs.size() == 2); // which find nothing to do
    auto next = connect("192.0.2.52");
    auto third = connect("192.0.2.53");
    CHECK_FALSE(next.is_closed());
    CHECK_FALSE(third.is_closed());
    CHECK(connect("192.0.2.54").is_closed());
    finish(next);
    third.run();
    CHECK(next.channel.is_open());
    CHECK(third.channel.is_open());
}

TEST_CASE_METHOD(Worked, "an answer is signed with the key that its request was for")
{
    auto client = connect();
    auto changed = fixture.server.config();
    changed.identity = make_identity("server");
    SECTION("if another one comes before the request is read")
    {
        REQUIRE(server::RunningServer{fixture.server}.reconfigure(changed));
        REQUIRE(work_once());
    }
    SECTION("or before the answer is signed")
    {
        REQUIRE(work_once());
        REQUIRE(server::RunningServer{fixture.server}.reconfigure(changed));
    }
    REQUIRE(work_once());
    client.run();
    CHECK(client.channel.is_open());
    fixture.advance(1s, client);
    CHECK(client.is_closed()); // as all with the old one
}

} // namespace channel_worker_test
