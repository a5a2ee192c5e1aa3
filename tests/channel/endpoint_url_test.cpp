#include <catch2/catch.hpp>

#include <string>

#include <busbar/channel/endpoint_url.hpp>

namespace endpoint_url_test {

using namespace busbar;
using channel::EndpointUrl;

TEST_CASE("an endpoint URL has host, port and path", "[channel]")
{
    const auto full = EndpointUrl::parse("opc.tcp://plc.example:4841/line/1");
    REQUIRE(full);
    CHECK(full->host == "plc.example");
    CHECK(full->port == 4841);
    CHECK(full->path == "/line/1");
    CHECK(full->text() == "opc.tcp://plc.example:4841/line/1");
    const auto plain = EndpointUrl::parse("OPC.TCP://10.0.0.1");
    REQUIRE(plain);
    CHECK(plain->port == 4840);
    CHECK(plain->text() == "opc.tcp://10.0.0.1:4840");
    const auto six = EndpointUrl::parse("opc.tcp://[fe80::1]:5000");
    REQUIRE(six);
    CHECK(six->host == "fe80::1");
    CHECK(six->port == 5000);
    CHECK(six->text() == "opc.tcp://[fe80::1]:5000");
}

TEST_CASE("what is no endpoint URL is refused", "[channel]")
{
    for (const std::string& url :
         {std::string{}, std::string{"opc.tcp://"}, std::string{"http://plc:4840"},
          std::string{"opc.tcp://:4840"}, std::string{"opc.tcp://plc:"},
          std::string{"opc.tcp://plc:0"}, std::string{"opc.tcp://plc:65536"},
          std::string{"opc.tcp://plc:x"}, std::string{"opc.tcp://[::1"},
          std::string{"opc.tcp://[::1]4840"}, std::string{"plc:4840"},
          "opc.tcp://" + std::string(4'090, 'h')}) {
        INFO(url);
        const auto endpoint = EndpointUrl::parse(url);
        REQUIRE_FALSE(endpoint);
        CHECK(endpoint.error() == status::Bad_TcpEndpointUrlInvalid);
    }
}

} // namespace endpoint_url_test
