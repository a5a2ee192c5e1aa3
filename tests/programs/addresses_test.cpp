#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>

#include "product/access/identity.hpp"
#include "product/configuration/addresses.hpp"
#include "product/life/startup.hpp"
#include "support/identity.hpp"
#include "support/temporary_folder.hpp"

namespace addresses_test {

using namespace busbar;
using namespace busbar::product;

namespace {

using Names = std::vector<std::string>;

ControllerConfig at(const std::string& address, const Names& host_names = {})
{
    ControllerConfig config;
    config.address = address;
    config.host_names = host_names;
    return config;
}

} // namespace

TEST_CASE("endpoints and certificate follow the address and host_names")
{
    struct Row {
        ControllerConfig config;
        std::string host;
        Names names;
    };
    const Row rows[] = {
        {at("192.0.2.7"), "192.0.2.7", {"192.0.2.7", "line3"}},
        {at("192.0.2.7", {"plc.example", "192.0.2.7"}),
         "192.0.2.7",
         {"192.0.2.7", "plc.example", "line3"}},
        {at("2001:db8::7"), "2001:db8::7", {"2001:db8::7", "line3"}},
        {at(""), "line3", {"line3", "localhost", "127.0.0.1"}},
        {at("0.0.0.0"), "line3", {"line3", "localhost", "127.0.0.1"}},
        {at("::", {"10.0.0.5", "LINE3"}), "line3", {"line3", "10.0.0.5", "localhost", "::1"}},
        {at("127.0.0.1"), "127.0.0.1", {"127.0.0.1", "line3", "localhost"}},
        {at("::1"), "::1", {"::1", "line3", "localhost"}},
    };
    for (const Row& row : rows) {
        INFO(row.config.address);
        CHECK(default_host(row.config, "line3") == row.host);
        CHECK(known_hosts(row.config, "line3", {}) == row.names);
    }
    channel::EndpointUrl url;
    url.host = default_host(at("2001:db8::7"), "line3");
    CHECK(url.text() == "opc.tcp://[2001:db8::7]:4840");
    CHECK_FALSE(machine_name().empty());
}

TEST_CASE("who listens to every address is known by those of the interfaces")
{
    const Names usual{"127.0.0.1", "::1", "10.0.0.7", "169.254.3.4", "2001:db8::7", "fe80::7"};
    const auto known = [](const std::string& address, const Names& interfaces) {
        return known_hosts(at(address, {"2001:DB8::7"}), "line3", interfaces);
    };
    // What host_names has is not named twice.
    CHECK(known("", usual) ==
          Names{"line3", "2001:DB8::7", "10.0.0.7", "localhost", "127.0.0.1", "::1"});
    CHECK(known("0.0.0.0", usual) ==
          Names{"line3", "2001:DB8::7", "10.0.0.7", "localhost", "127.0.0.1"});
    CHECK(known("::", usual) == Names{"line3", "2001:DB8::7", "localhost", "::1"});
    CHECK(known("10.0.0.7", usual) == Names{"10.0.0.7", "2001:DB8::7", "line3"});
    // Nothing but the cable to an engineer's computer.
    CHECK(known("", {"127.0.0.1", "169.254.3.4", "fe80::7"}) ==
          Names{"line3", "2001:DB8::7", "169.254.3.4", "fe80::7", "localhost", "127.0.0.1"});
}

TEST_CASE("a machine with very many addresses makes some of them known")
{
    Names many;
    for (int i = 0; i < 200; ++i) {
        many.push_back("10.0.0." + std::to_string(i));
    }
    const Names known = known_hosts(at(""), "line3", many);
    CHECK(known.size() == max_interface_addresses + 3);
    CHECK(known[1] == "10.0.0.0");
    for (const std::string& address : interface_addresses()) {
        CHECK(address.find_first_not_of("0123456789abcdef:.") == std::string::npos);
    }
}

TEST_CASE("a certificate that lacks a name says so, and can be made anew")
{
    const test::TemporaryFolder folder;
    ControllerConfig config = at("127.0.0.1");
    config.certificates.folder = folder.path.string();
    server::ServerConfig& server = config.server;
    const DateTime now = DateTime::from_unix_seconds(1'750'000'000);
    test::LogBook log;
    const auto load = [&](const Names& names) {
        server.host_names = names;
        server.identity =
            load_identity(config.certificates, "Line 3", server.application_uri, names, now, log);
        return welcome_text(config, 0, now, 0);
    };
    CHECK(load({"127.0.0.1", "line3"}).find("does not name") == std::string::npos);
    const std::string text = load({"127.0.0.1", "line3", "192.0.2.7"});
    INFO(text);
    const std::size_t place = text.find("does not name 192.0.2.7, by which clients");
    REQUIRE(place != std::string::npos);
    CHECK(text.substr(place, text.find('\n', place) - place).find("--regenerate-certificate") !=
          std::string::npos);
    const auto made = regenerate_certificate(config.certificates, "Line 3", server.application_uri,
                                             server.host_names, now);
    CHECK(load({"127.0.0.1", "line3", "192.0.2.7"}).find("does not name") == std::string::npos);
    CHECK(server.identity->certificates.front() == made);
    const auto names = made.host_names();
    CHECK(std::find(names.begin(), names.end(), "192.0.2.7") != names.end());
}

TEST_CASE("start-up lines name the endpoint and the other hosts")
{
    ControllerConfig config = at("2001:db8::7");
    config.server.endpoint_url = "opc.tcp://[2001:db8::7]:4840";
    config.server.host_names = {"2001:db8::7", "line3", "plc.example"};
    const std::string text = welcome_text(config, 5, {}, 0);
    CHECK(text.find(" with 5 variables at opc.tcp://[2001:db8::7]:4840\n") != std::string::npos);
    CHECK(text.find("clients may also use: line3, plc.example\n") != std::string::npos);
}

TEST_CASE("start-up lines say what has the PLC's scans begin in time")
{
    ControllerConfig config = at("127.0.0.1");
    const auto holds = [&](int granted, const std::string& line) {
        return welcome_text(config, 5, {}, granted)
                   .find("  plc: the task runs at " + line + "\n") != std::string::npos;
    };
    CHECK(holds(10, "real-time priority 10"));
    CHECK(holds(0, "ordinary priority, ahead of the server; raise it by CAP_SYS_NICE or "
                   "LimitRTPRIO=10"));
    config.realtime_priority = 0;
    CHECK(
        holds(0, "ordinary priority, ahead of the server; raise it by realtime_priority in [plc]"));
}

} // namespace addresses_test
