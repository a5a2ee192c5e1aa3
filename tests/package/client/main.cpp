#include <cstdio>
#include <vector>

#include <busbar/client/attributes.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/net/application.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/types/ids.hpp>

using namespace busbar;

/// Prints the time of a server. usage: client URL USER PASSWORD
int main(int argc, char** argv)
{
    net::StderrLog log{LogLevel::Warning};
    const auto application =
        net::Application::open({"urn:example:client", "Client", "client_pki"}, log);
    if (!application || argc < 4) {
        return 2;
    }
    client::ClientConfig config = (*application)->client_config(argv[1]);
    config.identity = client::NamedUser{argv[2], argv[3]};
    net::BlockingClient client{config, (*application)->client_environment()};
    const auto value = client.connect().and_then([&] {
        return client.wait_for<std::vector<DataValue>>([&](auto done) {
            return client::read(client.client(),
                                {client::attribute_of({0, id::Server_ServerStatus_CurrentTime})},
                                done);
        });
    });
    client.close();
    std::puts(value ? client::to_text(value->front()).c_str() : name(value.error()).data());
    return value ? 0 : 1;
}
