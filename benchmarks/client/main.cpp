// What a client costs: per value that it reads and per notification that it is sent, without the
// server's part; and how many connections and requests one thread has in a second when client and
// server are both in it. Bytes go through memory; there is no network.

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/client/attributes.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/asymmetric.hpp>
#include <busbar/net/server_loop.hpp>
#include <busbar/types/attribute.hpp>
#include <busbar/types/secure_channel.hpp>

#include "command_line/program_options.hpp"
#include "plant.hpp"

using namespace busbar;
using namespace busbar::bench;
using namespace std::chrono_literals;

namespace {

/// A Client with a session at a plant.
class User {
public:
    explicit User(Plant& plant)
        : client{plant.client_config(), plant.client_environment(), plant.now}, plant_{&plant}
    {
        client.connect(plant.now);
        run();
        if (client.state() != client::ClientState::Ready) {
            give_up("a session", client.last_error());
        }
    }

    /// Until nothing moves any more.
    void run()
    {
        for (bool moved = true; std::exchange(moved, false);) {
            watch.time([&] {
                while (client.poll(plant_->now)) {
                }
            });
            if (auto order = client.next_order()) {
                obey(*order);
                moved = true;
            }
            moved = (is_connected_ && plant_->carry(client, watch)) || moved;
        }
    }
    void read(const ReadRequest& request)
    {
        ReadRequest copy = request;
        bool is_done = false;
        watch.time([&] {
            client.call<ReadResponse>(std::move(copy), [&](const Result<ReadResponse>& response) {
                is_done = response && response->results.size() == request.nodes_to_read.size();
            });
        });
        run();
        if (!is_done) {
            give_up("Read", client.last_error());
        }
    }

    /// The client's part.
    Stopwatch watch;
    client::Client client;

private:
    void obey(const client::TransportOrder& order)
    {
        is_connected_ = order.kind == client::TransportOrder::Kind::Open;
        if (is_connected_) {
            plant_->accept();
            client.connected(order.id, plant_->now);
        } else {
            plant_->drop();
            client.disconnected(order.id, {}, plant_->now);
        }
    }

    Plant* plant_;
    bool is_connected_{false};
};

[[nodiscard]] ReadRequest read_of(std::uint32_t count, std::uint32_t first = 0)
{
    ReadRequest request;
    request.timestamps_to_return = TimestampsToReturn::Source;
    for (std::uint32_t i = 0; i < count; ++i) {
        ReadValueId& item = request.nodes_to_read.emplace_back();
        item.node_id = NodeId{1, (first + i) % variable_count};
        item.attribute_id = static_cast<std::uint32_t>(AttributeId::Value);
    }
    return request;
}

/// Requests that name other variables in turn, as many as there are.
[[nodiscard]] std::vector<ReadRequest> reads_of(std::uint32_t count)
{
    std::vector<ReadRequest> requests;
    for (std::uint32_t first = 0; first < variable_count; first += count) {
        requests.push_back(read_of(count, first));
    }
    return requests;
}

/// Of the client alone, in ns.
double read_cost(Plant& plant, std::uint32_t values, int rounds)
{
    User user{plant};
    const std::vector<ReadRequest> requests = reads_of(values);
    user.read(requests.back());
    user.watch.reset();
    for (int i = 0; i < rounds; ++i) {
        user.read(requests[static_cast<std::size_t>(i) % requests.size()]);
    }
    return user.watch.seconds() * 1e9 / rounds / values;
}

/// The same through client::read, which splits lists by the server's limits. In ns, and how much
/// of that copying the list takes, which the user keeps.
std::pair<double, double> service_read_cost(Plant& plant, std::uint32_t values, int rounds)
{
    User user{plant};
    std::vector<std::vector<ReadValueId>> lists;
    for (const ReadRequest& request : reads_of(values)) {
        lists.emplace_back(request.nodes_to_read.begin(), request.nodes_to_read.end());
    }
    std::size_t next = 0;
    client::ReadSettings settings;
    settings.timestamps = TimestampsToReturn::Source;
    Stopwatch copies;
    const auto read = [&] {
        bool is_done = false;
        const std::vector<ReadValueId>& kept = lists[next++ % lists.size()];
        client::Operation operation;
        copies.time([&] { std::vector<ReadValueId>{kept}; });
        user.watch.time([&] {
            operation = client::read(
                user.client, kept,
                [&](const std::vector<DataValue>& results) {
                    is_done = results.size() == values && !results.back().status.is_bad();
                },
                settings);
        });
        user.run();
        if (!is_done) {
            give_up("client::read", user.client.last_error());
        }
    };
    read();
    user.watch.reset();
    copies.reset();
    for (int i = 0; i < rounds; ++i) {
        read();
    }
    return {user.watch.seconds() * 1e9 / rounds / values, copies.seconds() * 1e9 / rounds / values};
}

/// From add_items to the last answer, in ns.
double item_cost(Plant& plant, int rounds)
{
    Stopwatch all;
    for (int i = 0; i < rounds; ++i) {
        User user{plant};
        std::size_t made = 0;
        client::SubscriptionHandlers handlers;
        handlers.on_item = [&](client::ItemHandle, const client::ItemStatus& status) {
            made += status.status.is_bad() ? 0 : 1U;
        };
        auto& subscriptions = user.client.subscriptions();
        const auto subscription = expect("create", subscriptions.create({}, handlers));
        user.run();
        std::vector<client::ItemSettings> items(variable_count);
        for (std::uint32_t j = 0; j < variable_count; ++j) {
            items[j].node = NodeId{1, j};
        }
        user.watch.reset();
        user.watch.time([&] {
            static_cast<void>(
                expect("items", subscriptions.add_items(subscription, std::move(items))));
        });
        user.run();
        if (made != variable_count) {
            give_up("items are missing", status::Bad_Timeout);
        }
        all.add(user.watch);
    }
    return all.seconds() * 1e9 / rounds / variable_count;
}

double notification_cost(Plant& plant, std::uint32_t rounds)
{
    User user{plant};
    std::size_t arrived = 0;
    client::SubscriptionHandlers handlers;
    handlers.on_data = [&](std::span<const client::DataChange> changes) {
        arrived += changes.size();
    };
    client::SubscriptionSettings settings;
    settings.publishing_interval = 100ms;
    auto& subscriptions = user.client.subscriptions();
    const auto subscription = expect("create", subscriptions.create(settings, handlers));
    std::vector<client::ItemSettings> items(variable_count);
    for (std::uint32_t i = 0; i < variable_count; ++i) {
        items[i].node = NodeId{1, i};
        items[i].sampling_interval = 100ms;
    }
    static_cast<void>(expect("items", subscriptions.add_items(subscription, std::move(items))));
    const auto pass = [&] {
        plant.pass(100ms);
        user.run();
    };
    user.run();
    pass();
    pass();
    arrived = 0;
    user.watch.reset();
    for (std::uint32_t i = 1; i <= rounds; ++i) {
        plant.set_all(i);
        pass();
        pass();
    }
    if (arrived != std::size_t{rounds} * variable_count) {
        give_up("notifications are missing", status::Bad_Timeout);
    }
    return user.watch.seconds() * 1e9 / static_cast<double>(arrived);
}

/// With the server's part.
double round_trips_per_second(Plant& plant, int rounds)
{
    User user{plant};
    const ReadRequest request = read_of(1);
    Stopwatch both;
    both.time([&] {
        for (int i = 0; i < rounds; ++i) {
            user.read(request);
        }
    });
    return rounds / both.seconds();
}

void connect_once(Plant& plant, Stopwatch& watch)
{
    plant.accept();
    std::optional<client::Connection> client;
    watch.time(
        [&] { client.emplace(plant.connection_config(), plant.client_environment(), plant.now); });
    bool is_ready = false;
    const auto poll = [&] {
        while (auto event = client->next_event()) {
            is_ready = is_ready || event->kind == client::ConnectionEvent::Kind::Ready;
        }
    };
    for (bool moved = true; moved && !is_ready;) {
        moved = plant.carry(*client, watch);
        watch.time(poll);
    }
    if (!is_ready) {
        give_up("connecting", status::Bad_ConnectionClosed);
    }
    client->close();
    while (plant.carry(*client, watch)) {
        poll();
    }
    plant.drop();
}

/// With the server's part, and the client's share of it.
std::pair<double, double> connects_per_second(Plant& plant, int rounds)
{
    Stopwatch both;
    Stopwatch own;
    connect_once(plant, own);
    own.reset();
    both.time([&] {
        for (int i = 0; i < rounds; ++i) {
            connect_once(plant, own);
        }
    });
    return {rounds / both.seconds(), own.seconds() / both.seconds()};
}

/// The RSA that such a connection cannot do without, both sides, in s: each signs and verifies an
/// OpenSecureChannel and a nonce, and encrypts and decrypts an OpenSecureChannel.
double rsa_of_connect(Plant& plant, int rounds)
{
    const channel::ApplicationIdentity& identity = *plant.client_environment().identity;
    const crypto::SecurityPolicy& policy = *plant.connection_config().channel.security.policy;
    const crypto::Certificate& certificate = identity.certificates.front();
    const std::size_t block = crypto::plain_block_size(policy, certificate.key_size());
    const std::vector<std::byte> text(block);
    OpenSecureChannelRequest open;
    open.client_nonce = ByteString{std::vector<std::byte>(policy.nonce_size)};
    // After the header of the sequence, and before padding and signature.
    const std::size_t size =
        8 + expect("a request", binary::to_bytes(open)).size() + 1 + certificate.key_size();
    const auto cipher = expect("encrypting", crypto::asymmetric_encrypt(policy, certificate, text));
    const auto signature = expect("signing", crypto::asymmetric_sign(policy, identity.key, text));
    Stopwatch watch;
    watch.time([&] {
        for (int i = 0; i < 4 * rounds; ++i) {
            static_cast<void>(crypto::asymmetric_sign(policy, identity.key, text));
            static_cast<void>(crypto::asymmetric_verify(policy, certificate, text, signature));
        }
        for (std::size_t i = 0;
             i < 2 * ((size + block - 1) / block) * static_cast<std::size_t>(rounds); ++i) {
            static_cast<void>(crypto::asymmetric_encrypt(policy, certificate, text));
            static_cast<void>(crypto::asymmetric_decrypt(policy, identity.key, cipher));
        }
    });
    return watch.seconds() / rounds;
}

/// A line of the table, without and with security; a rate is the better the larger it is.
struct Line {
    const char* what;
    const char* unit;
    bool is_rate{false};
    std::vector<double> none{};
    std::vector<double> secure{};

    void add(double without, double with)
    {
        none.push_back(without);
        secure.push_back(with);
    }
};

/// The best and the median of the rounds.
void print(Line line)
{
    const auto order = [&](double a, double b) { return line.is_rate ? a > b : a < b; };
    std::sort(line.none.begin(), line.none.end(), order);
    std::sort(line.secure.begin(), line.secure.end(), order);
    const std::size_t middle = line.none.size() / 2;
    std::printf("%-40s %10.0f %10.0f %10.0f %10.0f %s\n", line.what, line.none.front(),
                line.none[middle], line.secure.front(), line.secure[middle], line.unit);
}

/// All lines, measured round after round.
std::vector<Line> measure(int rounds, int part)
{
    enum : std::size_t {
        Read,
        Service,
        Copy,
        Item,
        LargeRead,
        Notification,
        One,
        Connect,
        Own,
        Rsa
    };
    std::vector<Line> lines{{"client, a value of Read 1,000", "ns"},
                            {"client, a value of client::read 1,000", "ns"},
                            {"of that a copy of the list", "ns"},
                            {"client, an item of 25,000 created", "ns"},
                            {"client, a value of Read 25,000", "ns"},
                            {"client, a notification of 25,000 items", "ns"},
                            {"Read of one value, client and server", "/s", true},
                            {"connect, activate, close, both sides", "/s", true},
                            {"of that the client's part", "%"},
                            {"its RSA alone", "us"}};
    const auto times = [&](int all) { return std::max(all / part / rounds, 1); };
    for (int round = 0; round < rounds; ++round) {
        Plant none{false};
        Plant secure{true};
        lines[Read].add(read_cost(none, 1'000, times(500)), read_cost(secure, 1'000, times(500)));
        const auto service = service_read_cost(none, 1'000, times(500));
        const auto secure_service = service_read_cost(secure, 1'000, times(500));
        lines[Service].add(service.first, secure_service.first);
        lines[Copy].add(service.second, secure_service.second);
        lines[Item].add(item_cost(none, times(5)), item_cost(secure, times(5)));
        lines[LargeRead].add(read_cost(none, 25'000, times(40)),
                             read_cost(secure, 25'000, times(40)));
        const auto scans = static_cast<std::uint32_t>(times(40));
        lines[Notification].add(notification_cost(none, scans), notification_cost(secure, scans));
        lines[One].add(round_trips_per_second(none, times(50'000)),
                       round_trips_per_second(secure, times(50'000)));
        const auto plain = connects_per_second(none, times(2'000));
        const auto encrypted = connects_per_second(secure, times(100));
        lines[Connect].add(plain.first, encrypted.first);
        lines[Own].add(plain.second * 100, encrypted.second * 100);
        lines[Rsa].add(0, rsa_of_connect(secure, times(100)) * 1e6);
    }
    return lines;
}

} // namespace

/// busbar-client-bench [part of the requests, as 1/n] [--rounds n]
int main(int argc, char** argv)
{
    int part = 1;
    int rounds = 5;
    CLI::App app{
        "Measures what a client costs: each value that it reads, each notification that it "
        "is sent, and how many requests and connections one thread has in a second. The best of "
        "the rounds and their median, in processor time."};
    app.add_option("part", part, "one in so many of the usual requests")
        ->check(CLI::Range(1, 1'000'000))
        ->capture_default_str();
    app.add_option("--rounds", rounds, "rounds over all lines")
        ->check(CLI::Range(1, 1'000))
        ->capture_default_str();
    command_line::add_program_options(app, "busbar-client-bench");
    CLI11_PARSE(app, argc, argv);
    NullLog log;
    const net::ServerLoop loop{log}; // sets the allocator as for every server and client of net
    const std::vector<Line> lines = measure(rounds, part);
    std::printf("%-40s %10s %10s %10s %10s\n", "", "None", "median", "Sign+Enc", "median");
    for (const Line& line : lines) {
        print(line);
    }
    return 0;
}
