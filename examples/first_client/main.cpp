// Prints a server's variables as they change: FIRST_CLIENT_PASSWORD=... first-client URL [SECONDS]
#include <cstdio>
#include <cstdlib>
#include <map>

#include <busbar/client/value_text.hpp>
#include <busbar/client/view.hpp>
#include <busbar/net/application.hpp>
#include <busbar/net/blocking_client.hpp>
#include <busbar/types/ids.hpp>

using namespace busbar;

static Result<void> watch(net::BlockingClient& client, std::chrono::seconds time)
{
    const auto tree = client.wait_for<client::BrowsedTree>([&](auto done) {
        return client::browse_tree(client.client(), {{0, id::ObjectsFolder}},
                                   client::children_of({}), done);
    });
    std::vector<client::ItemSettings> items;
    for (const client::TreeNode& node : tree ? tree->nodes : std::vector<client::TreeNode>{}) {
        const NodeId& id = node.reference.node_id.node_id;
        if (node.reference.node_class == NodeClass::Variable && id.namespace_index() != 0) {
            items.emplace_back().node = id;
        }
    }
    std::map<client::ItemHandle, std::string> names;
    client::SubscriptionHandlers handlers;
    handlers.on_data = [&](std::span<const client::DataChange> changes) {
        for (const client::DataChange& change : changes) {
            std::printf("%-30s %s\n", names[change.item].c_str(),
                        client::to_text(change.value).c_str());
        }
    };
    client::Subscriptions& subscriptions = client.client().subscriptions();
    const auto handles = subscriptions.create({}, handlers).and_then([&](auto subscription) {
        return subscriptions.add_items(subscription, items);
    });
    for (std::size_t i = 0; handles && i < items.size(); ++i) {
        names[(*handles)[i]] = items[i].node.text();
    }
    client.run_for(time);
    return handles.transform([](auto) {});
}

int main(int argc, char** argv)
{
    net::StderrLog log{LogLevel::Warning};
    const auto application = net::Application::open(
        {"urn:example:first-client", "First client", "first_client_pki"}, log);
    if (!application) {
        std::fprintf(stderr, "%s\n", text(application.error()).c_str());
        return 2;
    }
    const char* password = std::getenv("FIRST_CLIENT_PASSWORD");
    if (argc < 2 || password == nullptr) {
        return 2; // see above
    }
    client::ClientConfig config = (*application)->client_config(argv[1]);
    config.identity = client::NamedUser{"operator", password};
    net::BlockingClient client{config, (*application)->client_environment()};
    const std::chrono::seconds time{argc > 2 ? std::atoi(argv[2]) : 60};
    const auto done = client.connect().and_then([&] { return watch(client, time); });
    client.close();
    std::fprintf(stderr, "%s\n", std::string{name(done ? status::Good : done.error())}.c_str());
    return done ? 0 : 1;
}
