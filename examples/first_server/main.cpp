// A server with one variable and the security that a server has by default.
// usage: FIRST_SERVER_PASSWORD=... first-server [PORT]
#include <cstdlib>

#include <busbar/net/server_app.hpp>

using namespace busbar;

int main(int argc, char** argv)
{
    const std::string port = argc > 1 ? argv[1] : "4840";
    net::ServerApp app{{"urn:example:first-server", "First server", "first_server_pki"},
                       "opc.tcp://localhost:" + port};
    app.add_user("operator", std::getenv("FIRST_SERVER_PASSWORD"));
    const std::uint16_t machine = app.add_namespace("urn:example:machine");
    app.add_variable({machine, "Speed"}, 1480.0, model::Access::ReadWrite);
    return app.run();
}
