#include "session_world.hpp"

#include <string_view>

#include "quick_modules.hpp"
#include "require.hpp"

namespace busbar::fuzz {

namespace {

using std::chrono::milliseconds;

constexpr std::size_t secure_client = SessionWorld::client_count - 1;

channel::SecuritySetting signed_messages()
{
    return {crypto::find_policy_by_name("Basic256Sha256"), MessageSecurityMode::Sign};
}

server::ServerLimits small_limits()
{
    server::ServerLimits limits;
    limits.max_connections = 4;
    limits.max_sessions = 5;
    limits.max_sessions_per_user = 2;
    limits.max_sessions_per_channel = 3;
    limits.min_session_timeout = milliseconds{10'000};
    limits.max_session_timeout = milliseconds{60'000};
    limits.activation_timeout = milliseconds{20'000};
    limits.max_locale_ids = 2;
    limits.max_login_failures = 3;
    limits.max_login_failures_per_source = 5;
    limits.login_lock = milliseconds{10'000};
    limits.channel_interval = {};
    limits.failed_channel_interval = {};
    limits.subscriptions.min_publishing_interval = milliseconds{1'000};
    limits.subscriptions.max_lifetime = milliseconds{10'000};
    limits.subscriptions.max_keep_alive = milliseconds{3'000};
    return limits;
}

} // namespace

server::ServerConfig SessionWorld::config()
{
    server::ServerConfig config;
    config.identity = test::server_identity();
    config.application_uri = "urn:busbar:test:server";
    config.host_names = {"plc.example"};
    config.endpoints = {{}, {}};
    config.endpoints[0].password_policy = &crypto::policy_none();
    config.endpoints[0].allows_plain_passwords = true;
    config.endpoints[0].certificate_policy = crypto::find_policy_by_name("Basic256Sha256");
    config.endpoints[1].security = signed_messages();
    for (server::EndpointConfig& endpoint : config.endpoints) {
        endpoint.allows_anonymous = true;
        endpoint.allows_certificate = true;
    }
    config.limits = small_limits();
    return config;
}

SessionWorld::SessionWorld()
    : server_{server::Server::create(quick_modules(), config(),
                                     {.random = &random_,
                                      .wall_clock = &wall_clock_,
                                      .log = &log_,
                                      .validator = &validator_,
                                      .users = &users,
                                      .waker = &waker_})
                  .value()}
{
    users.validator = &validator_;
    jobs.most = 3;
}

void SessionWorld::begin()
{
    tickets = {{{}, ByteString{std::vector<std::byte>(32)}}};
    users.must_change = false;
    users.is_broken = false;
    users.everybody = server::anonymous_reader();
    users.rights = server::UserRights{};
    users.used_worker = nullptr;
}

test::TestClient& SessionWorld::client(std::size_t index)
{
    auto& client = clients_[index];
    if (client && client->is_closed()) {
        client.reset();
    }
    if (!client) {
        auto connection = server_.connect(index < 2 ? "192.0.2.1" : "198.51.100.7", now_);
        require(connection.has_value()); // there is a place for each of them
        client.emplace(*std::move(connection),
                       index == secure_client ? signed_messages() : channel::SecuritySetting{},
                       channel::ChannelEnvironment{.random = &random_,
                                                   .wall_clock = &wall_clock_,
                                                   .log = &log_,
                                                   .validator = &validator_,
                                                   .identity = &test::client_identity()},
                       now_);
    }
    return *client;
}

void SessionWorld::advance(Duration time)
{
    now_ += time;
    wall_clock_.time.ticks += time.count() / 100;
    server_.handle_deadline(now_);
    require(server_.next_deadline() > now_); // nobody drives a server in circles
    for (auto& client : clients_) {
        if (client) {
            client->connection.handle_deadline(now_);
            client->channel.handle_deadline(now_);
        }
    }
}

void SessionWorld::change_access()
{
    server_.announce_access_change(now_);
}

void SessionWorld::work()
{
    jobs.work_once();
    server_.handle_completions(now_);
}

void SessionWorld::check()
{
    require(server_.session_count() <= limits().max_sessions);
    require(server_.connection_count() <= client_count);
    for (auto& client : clients_) {
        if (!client) {
            continue;
        }
        client->run();
        for (const channel::ChannelEvent& message : client->messages) {
            binary::Reader reader{message.body};
            NodeId type;
            decode(reader, type);
            require(reader.ok());
        }
        client->messages.clear();
    }
}

bool SessionWorld::is_busy() const
{
    return server_.session_count() + server_.subscription_count() + server_.connection_count() != 0;
}

void SessionWorld::end()
{
    users.is_broken = false;
    while (!jobs.jobs.empty()) {
        work();
    }
    for (auto& client : clients_) {
        client.reset();
    }
    // Subscriptions count a late deadline once.
    for (int i = 0; i < 100 && (i == 0 || is_busy()); ++i) {
        now_ += std::chrono::minutes{3};
        wall_clock_.time.ticks += 180 * DateTime::ticks_per_second;
        server_.handle_deadline(now_);
    }
    require(!is_busy());
}

} // namespace busbar::fuzz
