// A server without security that has a namespace 0 of one size, for clients that crawl it.
// usage: sized-server micro|embedded|standard|full
// Prints its port and serves until SIGTERM.
#include <cstdint>
#include <cstdio>
#include <string_view>

#include <busbar/crypto/random.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/net/system.hpp>
#include <busbar/server/password_users.hpp>

#include <nodes_of/embedded/nodes.hpp>
#include <nodes_of/full/nodes.hpp>
#include <nodes_of/micro/nodes.hpp>
#include <nodes_of/standard/nodes.hpp>

using namespace busbar;

namespace {

const model::StaticNodes* nodes_of(std::string_view size)
{
    return size == "micro"      ? &test::micro_size::nodes()
           : size == "embedded" ? &test::embedded_size::nodes()
           : size == "standard" ? &test::standard_size::nodes()
           : size == "full"     ? &test::full_size::nodes()
                                : nullptr;
}

} // namespace

int main(int argc, char** argv)
{
    const model::StaticNodes* const nodes = argc == 2 ? nodes_of(argv[1]) : nullptr;
    if (nodes == nullptr) {
        std::fputs("usage: sized-server micro|embedded|standard|full\n", stderr);
        return 2;
    }
    net::StderrLog log{LogLevel::Warning};
    net::SystemWallClock wall_clock;
    crypto::SystemRandom random;
    server::PasswordUsers users;
    net::ServerLoop loop{log};
    const std::uint16_t port = loop.listen("127.0.0.1", 0).value_or(0);
    server::ServerConfig config;
    config.application_uri = "urn:busbar:test:sized";
    config.endpoint_url = "opc.tcp://127.0.0.1:" + std::to_string(port);
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].allows_user_name = false;
    config.shutdown_delay = std::chrono::milliseconds{0};
    auto server = server::Server::create(std::move(config),
                                         {.random = &random,
                                          .wall_clock = &wall_clock,
                                          .log = &log,
                                          .users = &users,
                                          .waker = &loop.waker()},
                                         model::AddressSpace{*nodes});
    if (!server || port == 0) {
        return 1;
    }
    loop.stop_on_signals();
    std::printf("ready %u\n", static_cast<unsigned>(port));
    std::fflush(stdout);
    loop.run(*server);
    return 0;
}
