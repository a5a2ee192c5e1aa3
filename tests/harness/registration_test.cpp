#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <busbar/harness/catch.hpp>
#include <busbar/harness/discovery_server.hpp>
#include <busbar/harness/identity.hpp>
#include <busbar/harness/registration_host.hpp>

#include "discovery_world.hpp"

namespace registration_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;
using busbar::test::discovery_url;
using busbar::test::found_servers;
using busbar::test::open_client;
using busbar::test::open_wishes;
using busbar::test::press;
using busbar::test::server_uri;

namespace {

const channel::SecuritySetting secure{crypto::find_policy_by_name("Basic256Sha256"),
                                      MessageSecurityMode::SignAndEncrypt};

const channel::ApplicationIdentity& press_identity()
{
    static const auto identity = *make_identity({"press"});
    return identity;
}

const channel::ApplicationIdentity& discovery_identity()
{
    static const auto identity = *make_identity({"discovery"});
    return identity;
}

/// Trusts every certificate that is right for the application it is shown for.
class ChecksApplication final : public crypto::CertificateValidator {
public:
    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override
    {
        return crypto::check_certificate(chain.front(), context);
    }
};

client::ClientConfig secure_client(client::SecurityWishes wishes = {})
{
    return client::registration_client(discovery_url, std::move(wishes), server_uri, true);
}

ClientParts press_parts()
{
    ClientParts parts;
    parts.identity = &press_identity();
    return parts;
}

DiscoveryServerOptions secure_options()
{
    DiscoveryServerOptions options;
    options.endpoints = {{}, secure};
    options.allows_unsecured = false;
    options.identity = &discovery_identity();
    return options;
}

std::size_t lines_with(World& world, std::string_view text)
{
    const std::string log = world.log().text();
    std::size_t count = 0;
    for (std::size_t at = log.find(text); at != std::string::npos; at = log.find(text, at + 1)) {
        ++count;
    }
    return count;
}

} // namespace

TEST_CASE("a server is registered at once and after each interval",
          "[registration][unit:Discovery Register2]")
{
    World world;
    DiscoveryServer discovery{world};
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    REQUIRE(press_server.await_registered(true, 1s));
    const auto* entry = discovery.find(server_uri);
    REQUIRE(entry != nullptr);
    CHECK(entry->server.is_online);
    CHECK(entry->server.product_uri.view() == "urn:busbar");
    CHECK(entry->server.discovery_urls[0].view() == "opc.tcp://press:4840");
    CHECK(entry->capabilities == std::vector<std::string>{"DA"});
    CHECK(found_servers(world) == "Discovery server;Press;");
    CHECK(discovery.count("RegisterServer2Request") == 1);
    world.run_for(1h + 1s);
    CHECK(discovery.count("RegisterServer2Request") == 13);
    CHECK(discovery.count("RegisterServerRequest") == 0);
    CHECK(discovery.find(server_uri) != nullptr);
    CHECK(lines_with(world, "discovery: ") == 1); // not each time

    press_server.stop();
    CHECK(discovery.find(server_uri) == nullptr);
    CHECK(discovery.count("RegisterServer2Request") == 14);
    CHECK(found_servers(world) == "Discovery server;");
    world.run_for(1h);
    CHECK(discovery.count("RegisterServer2Request") == 14);
}

TEST_CASE("the best endpoint is chosen, and what is told there believed", "[registration]")
{
    World world;
    DiscoveryServer discovery{world, secure_options()};
    RegistrationHost press_server{world, secure_client(open_wishes()), press(), press_parts()};
    press_server.start();
    REQUIRE(press_server.await_registered(true, 5s));
    CHECK(discovery.find(server_uri) != nullptr);
    press_server.stop();
    CHECK(discovery.find(server_uri) == nullptr);

    client::RegistrationSettings liar = press();
    liar.server.server_uri = "urn:busbar:harness:other";
    RegistrationHost other{world, secure_client(), liar, press_parts()};
    other.start();
    world.run_for(5s);
    CHECK(other.registration().last_result() == status::Bad_ServerUriInvalid);
    CHECK(discovery.entries().empty());
}

TEST_CASE("None is only for who allows it", "[registration]")
{
    World world;
    DiscoveryServer discovery{world};
    RegistrationHost careful{world, secure_client(), press(), press_parts()};
    careful.start();
    world.run_for(10min);
    CHECK_FALSE(careful.is_registered());
    CHECK(careful.registration().last_result() == status::Bad_SecurityPolicyRejected);
    CHECK(discovery.count("RegisterServer2Request") == 0);
    CHECK(lines_with(world, "is not registered") == 1);
    RegistrationHost careless{world, secure_client(open_wishes()), press(), press_parts()};
    careless.start();
    CHECK(careless.await_registered(true, 5s));
}

TEST_CASE("a discovery server that takes nothing without security says so", "[registration]")
{
    World world;
    DiscoveryServer discovery{world, secure_options()};
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    world.run_for(1min);
    CHECK(press_server.registration().last_result() == status::Bad_SecurityModeInsufficient);
    CHECK(found_servers(world) == "Discovery server;");
}

TEST_CASE("an old discovery server gets RegisterServer", "[registration][unit:Discovery Register]")
{
    World world;
    DiscoveryServerOptions options;
    options.knows_register_server_2 = false;
    auto discovery = std::make_unique<DiscoveryServer>(world, options);
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    REQUIRE(press_server.await_registered(true, 1s));
    CHECK(discovery->find(server_uri) != nullptr);
    world.run_for(21min);
    CHECK(discovery->count("RegisterServer2Request") == 1);
    CHECK(discovery->count("RegisterServerRequest") == 5);

    SECTION("until it was away, and perhaps replaced by a newer one")
    {
        discovery.reset();
        REQUIRE(press_server.await_registered(false, 10min));
        discovery = std::make_unique<DiscoveryServer>(world);
        REQUIRE(press_server.await_registered(true, 10min));
        CHECK(discovery->count("RegisterServer2Request") == 1);
        CHECK(discovery->count("RegisterServerRequest") == 0);
    }
    SECTION("at the end, too")
    {
        press_server.stop();
        CHECK(discovery->find(server_uri) == nullptr);
        CHECK(discovery->count("RegisterServer2Request") == 1);
    }
}

TEST_CASE("a discovery server that is away is asked ever less often", "[registration]")
{
    World world;
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    world.run_for(10s);
    CHECK(press_server.registration().last_result() == status::Bad_ConnectionRejected);
    world.run_for(1h);
    CHECK(lines_with(world, "is not registered") == 1);
    // Within an interval of being there, at the latest.
    DiscoveryServer discovery{world};
    REQUIRE(press_server.await_registered(true, 5min + 1s));
    CHECK(lines_with(world, "is registered") == 1);

    world.network().refuse();
    REQUIRE(press_server.await_registered(false, 6min));
    world.run_for(10min);
    CHECK(discovery.find(server_uri) == nullptr); // forgotten
    CHECK(lines_with(world, "is not registered") == 2);
    world.network().refuse(false);
    REQUIRE(press_server.await_registered(true, 6min));
    CHECK(discovery.find(server_uri) != nullptr);
    CHECK(lines_with(world, "is registered") == 2);
}

TEST_CASE("a discovery server that shows another's certificate is refused", "[registration]")
{
    World world;
    DiscoveryServerOptions options = secure_options();
    options.application_uri = "urn:busbar:harness:impostor";
    DiscoveryServer discovery{world, options};
    ChecksApplication validator;
    ClientParts parts = press_parts();
    parts.validator = &validator;
    RegistrationHost press_server{world, secure_client(), press(), parts};
    press_server.start();
    world.run_for(10min);
    CHECK_FALSE(press_server.is_registered());
    CHECK(press_server.registration().last_result() == status::Bad_CertificateUriInvalid);
    CHECK(discovery.count("RegisterServer2Request") == 0);
}

TEST_CASE("a discovery server may come back with another certificate", "[registration]")
{
    World world;
    DiscoveryServerOptions options = secure_options();
    auto discovery = std::make_unique<DiscoveryServer>(world, options);
    RegistrationHost press_server{world, secure_client(), press(), press_parts()};
    press_server.start();
    REQUIRE(press_server.await_registered(true, 5s));
    discovery.reset();
    const auto renewed = make_identity({"discovery"});
    REQUIRE(renewed);
    options.identity = &*renewed;
    discovery = std::make_unique<DiscoveryServer>(world, options);
    world.run_for(5min + 5s);
    CHECK(press_server.is_registered());
    CHECK(discovery->find(server_uri) != nullptr);
}

TEST_CASE("the time of day may jump", "[registration]")
{
    World world;
    DiscoveryServer discovery{world, secure_options()};
    RegistrationHost press_server{world, secure_client(), press(), press_parts()};
    press_server.start();
    REQUIRE(press_server.await_registered(true, 5s));
    for (const Duration jump : {Duration{24h}, Duration{-48h}}) {
        const std::size_t before = discovery.count("RegisterServer2Request");
        world.jump_clock(jump);
        world.run_for(20min + 1s);
        CHECK(discovery.count("RegisterServer2Request") == before + 4);
        CHECK(press_server.is_registered());
    }
}

TEST_CASE("a shutdown does not wait for a discovery server", "[registration]")
{
    World world;
    RegistrationHost press_server{world, open_client(), press()};
    const auto time_to_stop = [&] {
        const TimePoint before = world.now();
        press_server.stop();
        REQUIRE(press_server.registration().is_stopped());
        return world.now() - before;
    };
    SECTION("that never was there")
    {
        press_server.start();
        world.run_for(10s);
        CHECK(time_to_stop() == 0s);
    }
    SECTION("that was never asked for")
    {
        CHECK(time_to_stop() == 0s);
        press_server.start();
        world.run_for(1h);
        CHECK(world.network().connection_count() == 0);
    }
    SECTION("that does not answer any more")
    {
        ScriptedServer discovery{world, discovery_url};
        discovery.expect<RegisterServer2Request>().reply(RegisterServer2Response{});
        discovery.expect<RegisterServer2Request>();
        press_server.start();
        REQUIRE(press_server.await_registered(true, 5s));
        CHECK(time_to_stop() == 2s);
        CHECK(discovery.report() == "");
    }
    SECTION("that is gone")
    {
        auto discovery = std::make_unique<DiscoveryServer>(world);
        press_server.start();
        REQUIRE(press_server.await_registered(true, 5s));
        discovery.reset();
        world.run_for(1s);
        CHECK(time_to_stop() < 1s);
    }
}

TEST_CASE("a server that stops while it registers says so", "[registration]")
{
    World world;
    DiscoveryServer discovery{world};
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    const auto steps = GENERATE(range(1, 30));
    for (int i = 0; i < steps; ++i) {
        world.step();
    }
    const std::size_t before = discovery.count("RegisterServer2Request");
    press_server.stop();
    CHECK(press_server.registration().is_stopped());
    world.run_for(1min);
    CHECK(discovery.entries().empty());
    CHECK(discovery.count("RegisterServer2Request") <= before + 2);
}

TEST_CASE("a server that was taken back registers again when it is told to", "[registration]")
{
    World world;
    DiscoveryServer discovery{world};
    RegistrationHost press_server{world, open_client(), press()};
    press_server.start();
    REQUIRE(press_server.await_registered(true, 5s));
    press_server.start_again(); // it is registered
    const auto again = [&] {
        press_server.start_again();
        world.run_for(10s);
        REQUIRE(press_server.is_registered());
        CHECK_FALSE(press_server.registration().is_stopped());
        REQUIRE(discovery.entries().size() == 1);
        CHECK(discovery.find(server_uri)->server.is_online);
        const std::size_t before = discovery.count("RegisterServer2Request");
        world.run_for(1h + 1s);
        CHECK(discovery.count("RegisterServer2Request") == before + 12);
    };
    SECTION("later")
    {
        press_server.stop();
        CHECK(discovery.entries().empty());
        world.run_for(1h);
        CHECK(discovery.entries().empty());
        again();
    }
    SECTION("while it is being taken back")
    {
        const auto steps = GENERATE(range(0, 20));
        press_server.stop(0s);
        for (int i = 0; i < steps; ++i) {
            world.step();
        }
        again();
        press_server.stop();
        CHECK(discovery.entries().empty());
    }
    SECTION("and is not any more, as it stops for good")
    {
        press_server.stop(0s);
        press_server.start_again();
        press_server.stop();
        world.run_for(1h);
        CHECK(press_server.registration().is_stopped());
        CHECK(discovery.entries().empty());
    }
}

TEST_CASE("a log that tells everything once has an end", "[registration]")
{
    LogBook book;
    client::OnceLog log{book};
    const auto told = [&](const std::string& text) {
        book.clear();
        log.write(LogLevel::Warning, "discovery", text);
        return !book.text().empty();
    };
    CHECK(told("refused"));
    CHECK_FALSE(told("refused"));
    for (std::size_t i = 1; i < client::OnceLog::max_texts; ++i) {
        CHECK(told(std::to_string(i)));
    }
    CHECK_FALSE(told("one too many"));
    log.forget();
    CHECK(told("refused"));
}

TEST_CASE("settings that a discovery server would refuse are refused before", "[registration]")
{
    CHECK(client::Registration::check(press()));
    const auto refused = [](auto change) {
        client::RegistrationSettings settings = press();
        change(settings);
        const auto checked = client::Registration::check(settings);
        return checked ? StatusCode{} : checked.error();
    };
    CHECK(refused([](auto& s) { s.server.server_uri = {}; }) == status::Bad_ServerUriInvalid);
    CHECK(refused([](auto& s) { s.server.server_names.clear(); }) == status::Bad_ServerNameMissing);
    CHECK(refused([](auto& s) { s.server.discovery_urls.clear(); }) ==
          status::Bad_DiscoveryUrlMissing);
    CHECK(refused([](auto& s) { s.server.server_type = ApplicationType::Client; }) ==
          status::Bad_InvalidArgument);
    CHECK(refused([](auto& s) { s.mdns.mdns_server_name = std::string(64, 'x'); }) ==
          status::Bad_InvalidArgument);
    CHECK(refused([](auto& s) { s.interval = 9s; }) == status::Bad_OutOfRange);
    CHECK(refused([](auto& s) { s.interval = 601s; }) == status::Bad_OutOfRange);
}

} // namespace registration_test
