#include <busbar/harness/registration_host.hpp>

#include <utility>

namespace busbar::harness {

RegistrationHost::RegistrationHost(World& world, client::ClientConfig config,
                                   client::RegistrationSettings settings, ClientParts parts)
    : world_{world}, log_{world.new_log(Actor::Other)},
      random_{world.new_chance(Actor::Other).next()}, client_{world, std::move(config),
                                                              with_log(std::move(parts))},
      registration_{client_.client(), log_, random_, std::move(settings)},
      deadline_{world.scheduler(), [this] {
                    registration_.handle_deadline(world_.now());
                    static_cast<void>(client_.client()); // it does a step afterwards
                    await_deadline();
                }}
{
    client_.on_step([this] { await_deadline(); });
}

ClientParts RegistrationHost::with_log(ClientParts parts)
{
    parts.log = &log_;
    return parts;
}

void RegistrationHost::start()
{
    registration_.start(world_.now());
    static_cast<void>(client_.client());
}

void RegistrationHost::start_again()
{
    registration_.start_again(world_.now());
    static_cast<void>(client_.client());
}

void RegistrationHost::stop(Duration limit)
{
    registration_.stop(world_.now());
    static_cast<void>(client_.client());
    await_deadline();
    static_cast<void>(world_.run_until([this] { return registration_.is_stopped(); }, limit));
}

bool RegistrationHost::await_registered(bool is_wanted, Duration limit)
{
    return world_.run_until([&] { return is_registered() == is_wanted; }, limit);
}

} // namespace busbar::harness
