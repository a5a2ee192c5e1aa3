#include <catch2/catch.hpp>

#include "client_fixture.hpp"

namespace client_life_test {

using namespace busbar;
using namespace busbar::test;
using namespace std::chrono_literals;
using client::ClientState;

namespace {

using Statuses = std::vector<StatusCode>;

} // namespace

TEST_CASE("a request ends at its time, whatever happens to the connection meanwhile",
          "[unit:Session Client General Service Behaviour]")
{
    ClientFixture plant{ClientFixture::insecure()};
    SECTION("waiting for a session that does not come")
    {
        plant.is_reachable = false;
        plant.connect();
    }
    SECTION("under way")
    {
        plant.connect();
        plant.is_carrying = false;
    }
    plant.read({3s});
    plant.read();
    plant.run();
    plant.advance(3s - 1ns);
    CHECK(plant.answers.empty());
    plant.advance(1ns);
    CHECK(plant.answers == Statuses{status::Bad_Timeout});
    plant.advance(7s - 1ns);
    CHECK(plant.answers.size() == 1);
    plant.advance(1ns);
    CHECK(plant.answers == Statuses{status::Bad_Timeout, status::Bad_Timeout});
}

TEST_CASE("a request of a user who was idle has all of its time")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    // Nobody has told the client the time for a while.
    plant.is_carrying = false;
    plant.now += 4s;
    plant.read({1s});
    CHECK(plant.client.next_deadline() <= plant.now);
    plant.run();
    plant.advance(999ms);
    CHECK(plant.answers == Statuses{});
    plant.advance(1ms);
    CHECK(plant.answers == Statuses{status::Bad_Timeout});
}

TEST_CASE("the time that a request waits for a session is part of its own")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.also_on_state = [&](ClientState state) {
        plant.is_carrying = state != ClientState::Ready;
    };
    plant.read({3s});
    plant.run();
    plant.advance(2s);
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.advance(1s - 1ns);
    CHECK(plant.answers.empty());
    plant.advance(1ns);
    CHECK(plant.answers == Statuses{status::Bad_Timeout});
}

TEST_CASE("a late answer is dropped")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    plant.is_carrying = false;
    plant.read({1s});
    plant.advance(2s);
    plant.is_carrying = true;
    plant.run();
    CHECK(plant.answers == Statuses{status::Bad_Timeout});
    plant.read();
    plant.run();
    CHECK(plant.answers == Statuses{status::Bad_Timeout, status::Good});
}

TEST_CASE("requests wait for a session, or not at all")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.read();
    plant.read({0s, false});
    CHECK(plant.answers.empty()); // never from within call()
    plant.run();
    CHECK(plant.answers == Statuses{status::Bad_ServerNotConnected});
    plant.connect();
    CHECK(plant.answers == Statuses{status::Bad_ServerNotConnected, status::Good});
}

TEST_CASE("what was sent and not answered ends when the connection does")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    plant.is_carrying = false;
    plant.read();
    plant.run();
    plant.read(); // not sent yet: it may wait
    plant.read({0s, false});
    plant.cut();
    CHECK(plant.answers == Statuses{status::Bad_ConnectionClosed, status::Bad_ConnectionClosed});
    plant.is_carrying = true;
    plant.advance(1s);
    CHECK(plant.answers.size() == 3);
    CHECK(plant.answers.back() == status::Good);
}

TEST_CASE("a cancelled request has no handler, wherever it was")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    SECTION("waiting")
    {
        plant.client.cancel(plant.read());
    }
    SECTION("under way")
    {
        plant.is_carrying = false;
        const auto id = plant.read();
        plant.run();
        plant.client.cancel(id);
        plant.is_carrying = true;
    }
    SECTION("ended")
    {
        plant.cut();
        plant.client.cancel(plant.read({0s, false}));
    }
    SECTION("unknown")
    {
        plant.client.cancel(4'711);
    }
    plant.advance(1min);
    CHECK(plant.answers.empty());
    CHECK(plant.is_ready());
}

TEST_CASE("handlers may do as they like with the client")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    client::RequestId other = 0;
    int called = 0;
    const auto on_first = [&](auto act) {
        plant.client.call<ReadResponse>(ReadRequest{}, [&, act](Result<ReadResponse>) {
            ++called;
            act();
        });
        other = plant.read();
        plant.run();
    };
    SECTION("cancel another")
    {
        on_first([&] { plant.client.cancel(other); });
        CHECK(plant.answers.empty());
    }
    SECTION("ask again")
    {
        on_first([&] { plant.read(); });
        CHECK(plant.answers.size() == 2);
    }
    SECTION("close")
    {
        on_first([&] { plant.client.close(plant.now); });
        CHECK(plant.client.state() == ClientState::Closed);
        CHECK(plant.answers.size() == 1);
        CHECK(plant.site->server.session_count() == 0);
    }
    SECTION("close and connect")
    {
        on_first([&] {
            plant.client.close(plant.now);
            plant.client.connect(plant.now);
        });
        CHECK(plant.is_ready());
        CHECK(plant.site->server.session_count() == 1);
    }
    SECTION("close when ready, from the handler of states")
    {
        plant.also_on_state = [&](ClientState state) {
            if (state == ClientState::Waiting) {
                plant.client.close(plant.now);
            }
        };
        plant.cut();
        CHECK(plant.client.state() == ClientState::Closed);
        called = 1;
    }
    CHECK(called == 1);
}

TEST_CASE("a handler that asks again and again does not keep the client from its work")
{
    ClientFixture plant{ClientFixture::insecure()};
    int failures = 0;
    std::function<void()> ask = [&] {
        plant.client.call<ReadResponse>(ReadRequest{},
                                        [&](Result<ReadResponse> response) {
                                            if (!response && response.error() ==
                                                                 status::Bad_ServerNotConnected) {
                                                ++failures;
                                                ask();
                                            }
                                        },
                                        {0s, false});
    };
    ask();
    CHECK(plant.client.poll(plant.now, 10));
    CHECK(failures == 10);
    plant.connect();
    CHECK(plant.is_ready());
}

TEST_CASE("poll does what it is allowed to do and no more")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    for (int i = 0; i < 10; ++i) {
        plant.read({0s, true});
    }
    plant.is_carrying = false;
    CHECK(plant.client.poll(plant.now, 4));
    CHECK(plant.client.next_deadline() <= plant.now);
    CHECK_FALSE(plant.client.poll(plant.now, 100));
    CHECK(plant.client.next_deadline() > plant.now);
    plant.is_carrying = true;
    plant.run();
    CHECK(plant.answers == Statuses(10));
}

TEST_CASE("no more requests than the limit wait or are under way")
{
    auto config = ClientFixture::insecure();
    config.max_requests = 3;
    ClientFixture plant{config};
    for (int i = 0; i < 5; ++i) {
        plant.read();
    }
    plant.run();
    CHECK(plant.answers == Statuses{status::Bad_TooManyOperations, status::Bad_TooManyOperations});
    plant.connect();
    CHECK(plant.answers.size() == 5);
    CHECK(plant.answers.back() == status::Good);
    plant.read();
    plant.run();
    CHECK(plant.answers.back() == status::Good);
}

TEST_CASE("a request that cannot be sent fails, and the others do not")
{
    auto config = ClientFixture::insecure();
    config.transport.max_message_size = 100'000;
    ClientFixture plant{config};
    plant.connect();
    ReadRequest request;
    request.nodes_to_read.resize(20'000);
    StatusCode result;
    plant.client.call<ReadResponse>(std::move(request), [&](Result<ReadResponse> response) {
        result = response ? StatusCode{} : response.error();
    });
    plant.read();
    plant.run();
    CHECK(result == status::Bad_RequestTooLarge);
    CHECK(plant.answers == Statuses{status::Good});
}

TEST_CASE("a silent server is asked, twice, and given up", "[unit:Session Client KeepAlive]")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    plant.advance(10min); // with a session timeout of one
    CHECK(plant.is_ready());
    CHECK(plant.urls.size() == 1);
    CHECK(plant.site->server.session_count() == 1);
    plant.is_carrying = false;
    plant.advance(14s);
    CHECK(plant.is_ready());
    plant.advance(6s);
    CHECK_FALSE(plant.is_ready());
    CHECK(plant.client.last_error() == status::Bad_Timeout);
    plant.is_carrying = true;
    plant.advance(30s);
    CHECK(plant.is_ready());
}

TEST_CASE("a server that shuts down says so before it is gone",
          "[unit:Session Client Detect Shutdown]")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.server_config.shutdown_delay = 30s;
    plant.client.close(plant.now);
    plant.run();
    plant.restart(plant.server_config);
    plant.connect();
    REQUIRE(plant.is_ready());
    plant.site->server.begin_shutdown(plant.now, "maintenance");
    plant.advance(6s);
    CHECK(plant.client.server().state == ServerState::Shutdown);
    CHECK(plant.client.server().seconds_till_shutdown > 0);
    CHECK(plant.client.server().revision == 1);
}

TEST_CASE("clocks that jump do no harm")
{
    ClientFixture plant{ClientFixture::insecure()};
    plant.connect();
    plant.read();
    SECTION("forward")
    {
        plant.jump(24h);
        plant.advance(10s);
    }
    SECTION("back")
    {
        plant.advance(1h);
        CHECK_FALSE(plant.client.poll(plant.now - 30min));
        CHECK(plant.client.now() == plant.now);
        plant.advance(10s);
    }
    CHECK(plant.is_ready());
    CHECK(plant.answers.size() == 1);
    plant.read();
    plant.run();
    CHECK(plant.answers.back() == status::Good);
}

TEST_CASE("a connection that breaks at any byte of the handshake is made anew")
{
    const bool is_secure = GENERATE(false, true);
    // Between a cut in every message and a cut at every byte.
    const std::size_t step = is_secure ? 701 : 23;
    std::size_t cuts = 0;
    for (std::size_t size = 0;; size += step) {
        ClientFixture plant{is_secure ? ClientFixture::named_user() : ClientFixture::insecure()};
        plant.bytes_left = size;
        plant.connect();
        if (plant.is_ready()) {
            break;
        }
        ++cuts;
        plant.bytes_left = SIZE_MAX;
        plant.advance(5s);
        REQUIRE(plant.is_ready());
        plant.client.close(plant.now);
        plant.run();
        REQUIRE(plant.client.state() == ClientState::Closed);
    }
    CHECK(cuts > 10);
}

} // namespace client_life_test
