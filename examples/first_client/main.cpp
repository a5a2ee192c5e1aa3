// Prints the values of the Variable /Objects/Speed as they come.
// usage: FIRST_CLIENT_PASSWORD=... first-client URL [SECONDS]
#include <cstdio>
#include <cstdlib>

#include <busbar/client/value_text.hpp>
#include <busbar/net/application.hpp>
#include <busbar/net/blocking_client.hpp>

using namespace busbar;

int main(int argc, char** argv)
{
    const char* const password = std::getenv("FIRST_CLIENT_PASSWORD");
    if (argc < 2 || password == nullptr) {
        std::fprintf(stderr, "usage: FIRST_CLIENT_PASSWORD=... first-client URL [SECONDS]\n");
        return 2;
    }
    const char* const url = argv[1];
    const std::chrono::seconds time{argc > 2 ? std::atoi(argv[2]) : 60};
    net::StderrLog log{LogLevel::Warning};
    const auto application = net::Application::open(
        {"urn:example:first-client", "First client", "first_client_pki"}, log);
    if (!application) {
        std::fprintf(stderr, "%s\n", text(application.error()).c_str());
        return 1;
    }

    client::ClientConfig config = (*application)->client_config(url);
    config.identity = client::NamedUser{"operator", password};
    net::BlockingClient client{config, (*application)->client_environment()};
    client::SubscriptionHandlers handlers;
    handlers.on_data = [](std::span<const client::DataChange> changes) {
        for (const client::DataChange& change : changes) {
            std::printf("Speed %s\n", client::to_text(change.value).c_str());
        }
    };
    client::ItemSettings speed;
    speed.node = *client::NodeAddress::path("/Objects/Speed");
    client::Subscriptions& subscriptions = client.client().subscriptions();
    const auto items = subscriptions.create({}, handlers).and_then([&](auto subscription) {
        return subscriptions.add_items(subscription, {speed});
    });
    const auto connected = client.connect();
    client.run_for(connected ? time : std::chrono::seconds{0});

    client.close();
    const StatusCode status = !connected ? connected.error()
                              : !items   ? items.error()
                                         : StatusCode{};
    std::fprintf(stderr, "%s\n", std::string{name(status)}.c_str());
    return status.is_good() ? 0 : 1;
}
