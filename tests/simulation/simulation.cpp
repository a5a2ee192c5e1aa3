#include "simulation.hpp"

#include <malloc.h>

#include <algorithm>

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

Habits draw_habits(std::size_t number, Chance& chance)
{
    using enum Habits::Acknowledging;
    Habits habits;
    habits.acknowledging = chance.pick({AtOnce, AtOnce, Late, Never, Wrongly});
    habits.publish_requests = chance.pick<std::size_t>({1, 2, 3, 8, 8});
    habits.subscriptions = chance.pick<std::size_t>({1, 1, 2});
    habits.asks_after_return = chance.one_in(2);
    habits.is_secure = number % 25 == 1; // RSA takes most of the time
    habits.is_saturated = number % 20 == 3;
    if (habits.is_saturated) {
        habits.publish_requests = chance.pick<std::size_t>({1, 2});
        habits.subscriptions = 3;
    }
    return habits;
}

/// Reset connections, held up bytes, latencies of two continents.
void make_bad(Weather& weather)
{
    weather.max_latency = 150ms;
    weather.has_random_cuts = true;
    weather.stall_one_in = 200;
    weather.max_stall = 20s;
    weather.mean_life = 40min;
    weather.max_notice = 120s;
}

} // namespace

server::ServerConfig Simulation::config()
{
    server::ServerConfig config = ServerFixture::secure_config();
    config.endpoints.resize(1);
    server::EndpointConfig& open = config.endpoints.emplace_back();
    open.password_policy = &crypto::policy_none();
    open.allows_plain_passwords = true;
    // More than all good clients want, less than attackers do.
    config.limits.max_sessions = 250;
    config.limits.max_connections = 250;
    config.limits.subscriptions.max_subscriptions_per_user = 60;
    config.limits.subscriptions.max_subscriptions = 500;
    config.limits.max_log_lines_per_minute = 0;
    config.limits.subscriptions.max_publish_requests = 8;
    // Fewer than the specification wants, so that messages are lost for good now and then.
    config.limits.subscriptions.max_retransmission_messages = 6;
    return config;
}

/// Threads get their turn at once, as a rule, and sometimes when there were more scans.
harness::ServerParts Simulation::server_parts()
{
    harness::ServerParts parts;
    parts.users = &users_;
    parts.wake_delay = 2ms;
    parts.rare_wake_delay = 250ms;
    parts.watch = &memory_;
    return parts;
}

Simulation::Simulation(const SimulationOptions& options)
    : world_{options.seed}, chance_{options.seed, 1},
      memory_{scheduler_, trace_, Chance{options.seed, 4}}, plant_{scheduler_, world_.clock(),
                                                                   Chance{options.seed, 2}},
      host_{scheduler_, world_.clock(), log_, Chance{options.seed, 3}, config(), server_parts()},
      jump_{scheduler_, [this] { jump(); }}
{
    make_bad(weather_);
    plant_.serve(host_.server());
    static_cast<void>(world_.network().listen("opc.tcp://localhost:4840", host_));
    const SimulationParts parts{scheduler_, world_.clock(), weather_, memory_,
                                plant_,     host_,          trace_};
    const HostileParts hostile{scheduler_, world_.clock(), weather_,
                               host_,      trace_,         options.clients};
    for (std::size_t i = 1; i <= options.clients; ++i) {
        if (options.attackers_one_in != 0 && chance_.one_in(options.attackers_one_in)) {
            attackers_.push_back(
                std::make_unique<Attacker>(hostile, i, Chance{options.seed, 100 + i}));
            continue;
        }
        clients_.push_back(std::make_unique<Subscriber>(parts, i, draw_habits(i, chance_),
                                                        Chance{options.seed, 100 + i}));
    }
    for (std::size_t i = 1; i <= options.library_clients; ++i) {
        library_clients_.push_back(
            std::make_unique<LibraryClient>(world_, plant_, trace_, options.clients + i));
    }
}

void Simulation::jump()
{
    const Duration by = chance_.pick<Duration>(
        {chance_.between(-5s, 5s), chance_.between(-10min, 10min), chance_.between(-6h, 6h)});
    world_.jump_clock(by);
    jump_.set_after(chance_.between(1min, 30min));
}

void Simulation::run(std::chrono::minutes time)
{
    weather_.has_resets = true;
    memory_.start();
    plant_.start();
    jump_.set_after(1min);
    for (const auto& client : clients_) {
        client->start();
    }
    for (const auto& client : library_clients_) {
        client->start();
    }
    for (const auto& attacker : attackers_) {
        attacker->start();
    }
    for (std::chrono::minutes passed{0}; passed < time;) {
        const std::chrono::minutes next = std::min<std::chrono::minutes>(1h, time - passed);
        scheduler_.run_for(next);
        check_counts();
        passed += next;
    }
}

/// Beside what clients use there is what they have lost, for as long as the server must keep it,
/// and what attackers may have at most.
void Simulation::check_counts()
{
    const server::Server& server = host_.server();
    const server::ServerLimits& limits = server.config().limits;
    const std::size_t clients = clients_.size() + 3 * library_clients_.size();
    const std::size_t attackers = attackers_.size();
    const auto most = [&](std::size_t of_clients, std::size_t of_attacker, std::size_t limit) {
        return std::min(of_clients * clients + of_attacker * attackers, limit);
    };
    const std::size_t per_address = limits.max_connections_per_address;
    const std::size_t sessions = per_address * limits.max_sessions_per_channel;
    const std::size_t subscriptions = limits.subscriptions.max_subscriptions_per_user;
    const bool is_bounded =
        server.session_count() <= most(3, sessions, limits.max_sessions) &&
        server.connection_count() <= most(2, per_address, limits.max_connections) &&
        server.subscription_count() <=
            most(6, subscriptions, limits.subscriptions.max_subscriptions) &&
        server.monitored_item_count() <= 24 * clients;
    if (!is_bounded) {
        trace_.violation(0, "growth: " + std::to_string(server.session_count()) + " sessions, " +
                                std::to_string(server.connection_count()) + " connections, " +
                                std::to_string(server.subscription_count()) + " subscriptions, " +
                                std::to_string(server.monitored_item_count()) + " items");
    }
}

void Simulation::finish()
{
    weather_.has_resets = false;
    memory_.stop();
    jump_.cancel();
    for (const auto& attacker : attackers_) {
        attacker->leave();
    }
    for (const auto& client : clients_) {
        client->calm();
    }
    plant_.stop();
    scheduler_.run_for(20min);
    for (const auto& client : clients_) {
        client->check_arrivals();
        client->leave();
    }
    for (const auto& client : library_clients_) {
        client->check_arrivals();
        client->leave();
    }
    // The longest that sessions and Subscriptions which were lost live on.
    scheduler_.run_for(2h);
    check_empty();
}

void Simulation::check_empty()
{
    const server::Server& server = host_.server();
    if (server.session_count() != 0 || server.connection_count() != 0 ||
        server.subscription_count() != 0 || server.monitored_item_count() != 0) {
        trace_.violation(0, "something stays when all clients have left");
    }
}

std::size_t Simulation::heap_in_use()
{
#if defined(__SANITIZE_ADDRESS__)
    return 0;
#else
    const auto info = ::mallinfo2();
    return info.uordblks + info.hblkhd;
#endif
}

} // namespace busbar::test
