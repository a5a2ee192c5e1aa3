#include <catch2/catch.hpp>

#include <busbar/net/endpoint.hpp>

using namespace busbar;

TEST_CASE("an endpoint URL has host, port and path", "[net]")
{
    const auto full = net::parse_endpoint_url("opc.tcp://plc.example:4841/line/1");
    REQUIRE(full);
    CHECK(full->host == "plc.example");
    CHECK(full->port == 4841);
    CHECK(full->path == "/line/1");
    const auto plain = net::parse_endpoint_url("opc.tcp://10.0.0.1");
    REQUIRE(plain);
    CHECK(plain->port == 4840);
    const auto six = net::parse_endpoint_url("opc.tcp://[fe80::1]:5000");
    REQUIRE(six);
    CHECK(six->host == "fe80::1");
    CHECK(six->port == 5000);
}

TEST_CASE("what is no endpoint URL is refused", "[net]")
{
    for (const char* url : {"", "opc.tcp://", "http://plc:4840", "opc.tcp://:4840",
                            "opc.tcp://plc:", "opc.tcp://plc:0", "opc.tcp://plc:65536",
                            "opc.tcp://plc:x", "opc.tcp://[::1", "opc.tcp://[::1]4840"}) {
        INFO(url);
        const auto endpoint = net::parse_endpoint_url(url);
        REQUIRE_FALSE(endpoint);
        CHECK(endpoint.error() == status::Bad_TcpEndpointUrlInvalid);
    }
}
