#include "subscription_world.hpp"

#include <algorithm>
#include <string>

#include <busbar/types/ids.hpp>

#include "quick_modules.hpp"

namespace busbar::fuzz {

namespace {

using std::chrono::milliseconds;

server::SubscriptionLimits few_subscriptions()
{
    server::SubscriptionLimits limits;
    limits.max_subscriptions_per_session = 3;
    limits.max_subscriptions = 5;
    limits.max_items_per_subscription = 6;
    limits.max_items = 12;
    limits.min_publishing_interval = milliseconds{100};
    limits.max_publishing_interval = milliseconds{1'000};
    limits.max_lifetime = milliseconds{15'000};
    limits.max_keep_alive = milliseconds{5'000};
    limits.max_queue_size = 4;
    limits.max_event_queue_size = 4;
    limits.max_publish_requests = 4;
    limits.max_acknowledgements = 4;
    limits.max_retransmission_messages = 4;
    limits.max_message_size = 4'000;
    limits.max_status_changes = 2;
    limits.max_subscription_memory = 20'000;
    limits.max_memory = 40'000;
    return limits;
}

} // namespace

server::ServerConfig SubscriptionWorld::config()
{
    server::ServerConfig config;
    config.endpoints = {{}};
    config.endpoints[0].allows_anonymous = true;
    config.endpoints[0].password_policy = crypto::find_policy_by_name("None");
    config.endpoints[0].allows_plain_passwords = true;
    config.limits.subscriptions = few_subscriptions();
    config.limits.min_session_timeout = config.limits.max_session_timeout = milliseconds{10'000};
    return config;
}

SubscriptionWorld::SubscriptionWorld()
    : server_{server::Server::create(quick_modules(), config(),
                                     {.random = &random_,
                                      .wall_clock = &wall_clock,
                                      .log = &log_,
                                      .users = &users,
                                      .access = &access})
                  .value()}
{
    source_ = server_.add_source(memory_);
    for (std::uint64_t& handle : handles_) {
        handle = memory_.add({});
    }
}

void SubscriptionWorld::add_variable(std::size_t index)
{
    model::NewVariable variable;
    variable.source = source_;
    variable.handle = handles_[index];
    variable.data_type = NodeId{0, id::BaseDataType};
    variable.value_rank = -2; // any
    model::NewNode node;
    node.id = this->variable(index);
    node.browse_name = QualifiedName{1, "variable " + std::to_string(index)};
    node.parent = space().find(id::ObjectsFolder);
    require(space().add_variable(node, variable).has_value());
}

void SubscriptionWorld::begin()
{
    subscriptions = {0};
    items = {0};
    sequence_.clear();
    users.valid_until = {};
    access.blind.clear();
    access.shut_out.clear();
    const std::array values{Variant{1}, Variant{Array<double>{1, 2, 3}}, Variant{"text"}};
    for (std::size_t i = 0; i < variable_count; ++i) {
        memory_.set(handles_[i], values[i]);
        if (const model::NodeIndex node = space().find(variable(i)); node != model::no_node) {
            static_cast<void>(space().remove(node));
        }
        add_variable(i);
    }
    for (std::size_t i = 0; i < client_count; ++i) {
        connect(i);
        log_in(i, "maria");
    }
}

NodeId SubscriptionWorld::variable(std::size_t index) const
{
    return {1, static_cast<std::uint32_t>(index + 1)};
}

void SubscriptionWorld::connect(std::size_t index)
{
    clients_[index].reset();
    auto connection = server_.connect("192.0.2.1", now);
    require(connection.has_value());
    clients_[index].emplace(
        *std::move(connection), channel::SecuritySetting{},
        channel::ChannelEnvironment{.random = &random_, .wall_clock = &wall_clock, .log = &log_},
        now);
}

void SubscriptionWorld::log_in(std::size_t index, std::string_view user)
{
    test::TestClient& client = *clients_[index];
    if (client.authentication_token.is_null() && !client.create_session()) {
        return;
    }
    UserNameIdentityToken token;
    token.policy_id = "username_None";
    token.user_name = user;
    token.password = ByteString{std::vector<std::byte>(1)};
    static_cast<void>(client.activate(user.empty() ? test::TestClient::anonymous()
                                                   : ExtensionObject::from(std::move(token))));
}

void SubscriptionWorld::reconnect(std::size_t index, std::string_view user)
{
    sequence_.clear(); // what was on its way is lost
    connect(index);
    log_in(index, user);
}

void SubscriptionWorld::advance(Duration time)
{
    now += time;
    wall_clock.time.ticks += time.count() / 100;
    server_.handle_deadline(now);
    require(server_.next_deadline() > now); // nobody drives a server in circles
    for (auto& client : clients_) {
        client->connection.handle_deadline(now);
        client->channel.handle_deadline(now);
        client->run();
    }
}

void SubscriptionWorld::check_message(const PublishResponse& response)
{
    const NotificationMessage& message = response.notification_message;
    const bool is_status_change =
        message.notification_data.size() == 1 &&
        message.notification_data[0].get_if<StatusChangeNotification>() != nullptr;
    if (is_status_change) {
        return; // of a Subscription that is somebody else's by now, or none
    }
    const auto last = sequence_.find(response.subscription_id);
    const std::uint32_t expected =
        last == sequence_.end() ? message.sequence_number : last->second + 1;
    require(message.sequence_number == expected && expected != 0);
    const bool is_keep_alive = message.notification_data.empty();
    sequence_[response.subscription_id] = is_keep_alive ? expected - 1 : expected;
    require(!is_keep_alive || !response.more_notifications);

    const auto& available = response.available_sequence_numbers;
    require(available.size() <= server_.config().limits.subscriptions.max_retransmission_messages);
    require(std::is_sorted(available.begin(), available.end()));
    require(std::all_of(available.begin(), available.end(),
                        [&](std::uint32_t n) { return n < expected + (is_keep_alive ? 0 : 1); }));
}

void SubscriptionWorld::check_counts() const
{
    const server::SubscriptionLimits& limits = server_.config().limits.subscriptions;
    require(server_.subscription_count() <= limits.max_subscriptions);
    require(server_.monitored_item_count() <= limits.max_items);
    require(server_.monitored_item_count() <=
            server_.subscription_count() * limits.max_items_per_subscription);
}

void SubscriptionWorld::check()
{
    for (auto& client : clients_) {
        client->run();
        while (!client->messages.empty()) {
            const auto response =
                client->take<PublishResponse>(client->messages.front().request_id);
            // Good, or a fault, and never something that cannot be decoded.
            require(response || response.error() != status::Bad_DecodingError);
            if (response) {
                check_message(*response);
            }
        }
    }
    check_counts();
}

void SubscriptionWorld::finish()
{
    for (auto& client : clients_) {
        CloseSessionRequest close;
        close.delete_subscriptions = true;
        static_cast<void>(client->send(close));
    }
    // Sessions of connections that died live 10 s, and what they left behind 15 s more.
    for (int i = 0; i < 300 && is_busy(); ++i) {
        advance(milliseconds{100});
    }
    require(!is_busy());
    for (auto& client : clients_) {
        client.reset();
    }
    require(server_.connection_count() == 0);
}

bool SubscriptionWorld::is_busy() const
{
    return server_.session_count() + server_.subscription_count() +
               server_.monitored_item_count() !=
           0;
}

} // namespace busbar::fuzz
