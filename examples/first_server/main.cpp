// A server with one variable, behind the security that a server has by default.
// usage: FIRST_SERVER_PASSWORD=... first-server [PORT]
#include <cstdio>
#include <cstdlib>

#include <busbar/net/application.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/server/memory_source.hpp>
#include <busbar/server/password_users.hpp>
#include <busbar/types/ids.hpp>

using namespace busbar;

/// Serves `application` until Ctrl+C; why not, otherwise.
static Result<void> serve(net::Application& application, server::UserStore& users, LogSink& log,
                          std::uint16_t port)
{
    net::ServerLoop loop{log};
    server::MemorySource source{application.wall_clock()}; // outlives the server
    auto server = server::Server::create(
        application.server_config("opc.tcp://localhost:" + std::to_string(port)),
        application.server_environment(loop, &users));
    if (!server) {
        return fail(server.error());
    }
    model::AddressSpace& space = server->address_space();
    const std::uint16_t ns = space.add_namespace("urn:example:machine").value_or(0);

    model::NewNode speed;
    speed.id = NodeId{ns, "Speed"};
    speed.browse_name = QualifiedName{ns, "Speed"};
    speed.parent = space.find(id::ObjectsFolder);
    model::NewVariable variable;
    variable.data_type = NodeId{0, id::Double};
    variable.access_level = 3; // CurrentRead and CurrentWrite
    variable.source = server->add_source(source);
    variable.handle = source.add(Variant{1480.0});
    const auto added = space.add_variable(speed, variable);
    const auto listening = loop.listen("", port);
    if (!added || !listening) {
        return fail(added ? listening.error() : added.error());
    }
    loop.stop_on_signals();
    loop.run(*server);
    return {};
}

int main(int argc, char** argv)
{
    net::StderrLog log;
    auto application = net::Application::open(
        {"urn:example:first-server", "First server", "first_server_pki"}, log);
    if (!application) {
        std::fprintf(stderr, "%s\n", text(application.error()).c_str());
        return 1;
    }
    server::PasswordUsers users;
    const char* password = std::getenv("FIRST_SERVER_PASSWORD");
    const auto user = users.add("operator", password ? password : "", (*application)->random());
    if (!user) {
        std::fprintf(stderr, "FIRST_SERVER_PASSWORD: %s\n", text(user.error()).c_str());
        return 1;
    }
    const int port = argc > 1 ? std::atoi(argv[1]) : 4840;
    const auto served = serve(**application, users, log, static_cast<std::uint16_t>(port));
    if (!served) {
        std::fprintf(stderr, "%s\n", std::string{name(served.error())}.c_str());
    }
    return served ? 0 : 1;
}
