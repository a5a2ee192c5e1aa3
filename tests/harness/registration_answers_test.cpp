#include <catch2/catch.hpp>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/registration_host.hpp>
#include <busbar/harness/scripted_server.hpp>

#include "discovery_world.hpp"

namespace registration_answers_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;
using busbar::test::discovery_url;
using busbar::test::open_client;
using busbar::test::press;

TEST_CASE("some old discovery servers close the connection", "[registration]")
{
    World world;
    ScriptedServer discovery{world, discovery_url};
    discovery.expect<RegisterServer2Request>().close(status::Bad_ServiceUnsupported);
    discovery.expect<RegisterServerRequest>().reply(RegisterServerResponse{});
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    CHECK(press_server.await_registered(true, 5s));
    CHECK(discovery.report() == "");
}

TEST_CASE("attempts begin after a second and double up to the interval", "[registration]")
{
    World world;
    ScriptedServer discovery{world, discovery_url};
    discovery.allow<RegisterServer2Request>().fail(status::Bad_ServerUriInvalid);
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    world.run_for(3s);
    CHECK(discovery.came().size() >= 2);
    CHECK(discovery.came().size() <= 3);
    world.run_for(1h);
    const std::size_t before = discovery.came().size();
    world.run_for(2h);
    CHECK(discovery.came().size() - before >= 24); // once in an interval
    CHECK(discovery.came().size() - before <= 30); // or a fifth sooner
}

TEST_CASE("answers that are none leave the server unregistered and go on", "[registration]")
{
    World world;
    ScriptedServer discovery{world, discovery_url};
    RegistrationHost press_server{world, open_client(), press()};
    constexpr int attempts = 7; // of 70 seconds, each wait twice as long
    const auto ends_with = [&](StatusCode expected) {
        press_server.start();
        world.run_for(70s);
        CHECK_FALSE(press_server.is_registered());
        CHECK(press_server.registration().last_result() == expected);
        discovery.allow<RegisterServer2Request>().reply(RegisterServer2Response{});
        CHECK(press_server.await_registered(true, 5min));
    };
    SECTION("another response")
    {
        for (int i = 0; i < attempts; ++i) {
            discovery.expect<RegisterServer2Request>().reply(FindServersResponse{});
        }
        ends_with(status::Bad_DecodingError);
    }
    SECTION("both services are said to be unknown")
    {
        for (int i = 0; i < attempts; ++i) {
            discovery.expect<RegisterServer2Request>().fail(status::Bad_ServiceUnsupported);
            discovery.expect<RegisterServerRequest>().fail(status::Bad_ServiceUnsupported);
        }
        ends_with(status::Bad_ServiceUnsupported);
    }
    SECTION("a lost connection that is none")
    {
        // For which the Registration gives the Client a minute to say more.
        for (int i = 0; i < 2; ++i) {
            discovery.expect<RegisterServer2Request>().fail(status::Bad_SecureChannelClosed);
        }
        ends_with(status::Bad_Timeout);
    }
    SECTION("none at all")
    {
        for (int i = 0; i < 5; ++i) { // each takes ten seconds
            discovery.expect<RegisterServer2Request>();
        }
        ends_with(status::Bad_Timeout);
    }
    SECTION("the connection is cut")
    {
        for (int i = 0; i < attempts; ++i) {
            discovery.expect<RegisterServer2Request>().cut();
        }
        ends_with(status::Bad_ConnectionClosed);
    }
}

TEST_CASE("what is said of the mDNS configuration does not matter", "[registration]")
{
    World world;
    ScriptedServer discovery{world, discovery_url};
    RegisterServer2Response response;
    for (int i = 0; i < 1'000; ++i) {
        response.configuration_results.push_back(status::Bad_NotSupported);
    }
    discovery.expect<RegisterServer2Request>().reply(response);
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    CHECK(press_server.await_registered(true, 5s));
    CHECK(world.log().contains("mDNS: Bad_NotSupported"));
}

} // namespace registration_answers_test
