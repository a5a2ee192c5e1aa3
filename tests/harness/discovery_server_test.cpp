#include <catch2/catch.hpp>

#include <string>
#include <utility>

#include <busbar/harness/catch.hpp>

#include "discovery_world.hpp"

namespace discovery_server_test {

using namespace busbar;
using namespace busbar::harness;
using namespace std::chrono_literals;
using busbar::test::server_uri;

namespace {

/// Somebody who sends a discovery server what registrations would not.
class Caller {
public:
    explicit Caller(DiscoveryServerOptions options = {}) : discovery{world, std::move(options)}
    {
        REQUIRE(client_.open());
    }
    StatusCode send(RegisteredServer server)
    {
        RegisterServerRequest request;
        request.server = std::move(server);
        const auto response = client_.call<RegisterServerResponse>(std::move(request));
        return response ? StatusCode{} : response.error();
    }

    World world;
    DiscoveryServer discovery;

private:
    ConnectionHost client_{world, test::discovery_connection()};
};

RegisteredServer online_press()
{
    RegisteredServer server = test::press().server;
    server.is_online = true;
    return server;
}

} // namespace

TEST_CASE("the discovery server of the harness forgets who is silent", "[registration]")
{
    Caller caller;
    RegisteredServer server = online_press();
    SECTION("for ten minutes")
    {
        CHECK(caller.send(server) == status::Good);
        caller.world.run_for(9min);
        CHECK(caller.discovery.find(server_uri) != nullptr);
        caller.world.run_for(1min);
        CHECK(caller.discovery.find(server_uri) == nullptr);
    }
    SECTION("but for those with a semaphore file, as long as that is there")
    {
        server.semaphore_file_path = "/run/press";
        CHECK(caller.send(server) == status::Bad_SemaphoreFileMissing);
        caller.discovery.semaphore_files().insert("/run/press");
        server.is_online = false; // counts less
        CHECK(caller.send(server) == status::Good);
        caller.world.run_for(1h);
        CHECK(caller.discovery.find(server_uri) != nullptr);
        caller.discovery.semaphore_files().clear();
        CHECK(caller.discovery.find(server_uri) == nullptr);
    }
}

TEST_CASE("the discovery server of the harness names what is missing", "[registration]")
{
    Caller caller;
    const auto refused = [&](auto change) {
        RegisteredServer changed = online_press();
        change(changed);
        return caller.send(changed);
    };
    CHECK(refused([](auto& s) { s.server_uri = {}; }) == status::Bad_ServerUriInvalid);
    CHECK(refused([](auto& s) { s.server_names.clear(); }) == status::Bad_ServerNameMissing);
    CHECK(refused([](auto& s) { s.discovery_urls.clear(); }) == status::Bad_DiscoveryUrlMissing);
    CHECK(refused([](auto& s) { s.server_type = ApplicationType::Client; }) ==
          status::Bad_InvalidArgument);
    CHECK(refused([](auto& s) { s.product_uri = std::string(5'000, 'x'); }) ==
          status::Bad_InvalidArgument);
    CHECK(caller.discovery.entries().empty());
}

TEST_CASE("the discovery server of the harness has its limits", "[registration]")
{
    DiscoveryServerOptions options;
    options.limits.max_servers = 2;
    Caller caller{options};
    for (const char* uri : {"urn:a", "urn:b", "urn:c", "urn:a"}) {
        RegisteredServer server = online_press();
        server.server_uri = uri;
        CHECK(caller.send(server) == (server.server_uri.view() == "urn:c"
                                          ? StatusCode{status::Bad_ResourceUnavailable}
                                          : StatusCode{}));
    }
}

TEST_CASE("servers are found by URI and named in the client's language",
          "[registration][unit:Discovery Client Find Servers with URI]")
{
    Caller caller;
    CHECK(caller.send(online_press()) == status::Good);
    FindServersRequest request;
    request.server_uris.push_back(String{server_uri});
    request.locale_ids.push_back(String{"de"});
    CHECK(test::found_servers(caller.world, request) == "Presse;");
}

TEST_CASE("servers that gave their mDNS configuration are found as those of the network",
          "[registration][unit:Discovery Client Find Servers on Network]")
{
    Caller caller;
    ConnectionHost client{caller.world, test::discovery_connection()};
    REQUIRE(client.open());
    const auto add = [&](const char* uri, const char* name, Array<String> capabilities) {
        RegisterServer2Request request;
        request.server = online_press();
        request.server.server_uri = uri;
        MdnsDiscoveryConfiguration mdns;
        mdns.mdns_server_name = name;
        mdns.server_capabilities = std::move(capabilities);
        request.discovery_configuration.push_back(ExtensionObject::from(mdns));
        REQUIRE(client.call<RegisterServer2Response>(std::move(request)));
    };
    add("urn:b", "Press 2", {"DA"});
    add("urn:a", "Press 1", {"DA", "HD"});
    add("urn:b", "Press two", {"DA"}); // the same record
    CHECK(caller.send(online_press()) == status::Good);
    const auto found = [&](std::uint32_t after, std::uint32_t most, Array<String> wanted) {
        FindServersOnNetworkRequest request;
        request.starting_record_id = after;
        request.max_records_to_return = most;
        request.server_capability_filter = std::move(wanted);
        const auto response = client.call<FindServersOnNetworkResponse>(std::move(request));
        REQUIRE(response);
        std::string names;
        for (const ServerOnNetwork& server : response->servers) {
            names += std::to_string(server.record_id) + " " + server.server_name.str() + ";";
        }
        return names;
    };
    CHECK(found(0, 0, {}) == "1 Press two;2 Press 1;");
    CHECK(found(1, 0, {}) == "2 Press 1;");
    CHECK(found(0, 1, {}) == "1 Press two;");
    CHECK(found(0, 0, {"hd"}) == "2 Press 1;");
}

} // namespace discovery_server_test
