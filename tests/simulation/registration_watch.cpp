#include "registration_watch.hpp"

#include <busbar/core/text.hpp>

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

client::RegistrationSettings settings()
{
    client::RegistrationSettings settings;
    settings.server.server_uri = "urn:busbar:test:registered";
    settings.server.server_names.push_back(LocalizedText{"en", "Registered"});
    settings.server.server_type = ApplicationType::Server;
    settings.server.discovery_urls.push_back("opc.tcp://registered:4840");
    settings.interval = 2min;
    return settings;
}

client::ClientConfig registration_config()
{
    client::SecurityWishes security;
    security.allows_none = true;
    return client::registration_client("opc.tcp://moody:4840", security,
                                       "urn:busbar:test:registered", false);
}

} // namespace

RegistrationWatch::RegistrationWatch(World& world, Trace& trace)
    : world_{world}, trace_{trace}, chance_{world.new_chance(harness::Actor::Other)}, log_{null_},
      random_{chance_.next()}, host_{world, registration_config(), {.log = &log_}},
      registration_{host_.client(), log_, random_, settings()}
{
    registration_.start(world_.now());
}

void RegistrationWatch::violation(const std::string& what)
{
    trace_.violation(0, "registration: " + what + ", last result " +
                            std::string{name(registration_.last_result())});
}

void RegistrationWatch::check()
{
    const TimePoint now = world_.now();
    static_cast<void>(host_.client()); // it may be told something below
    if (registration_.next_deadline() <= now) {
        registration_.handle_deadline(now);
    }
    if (stopped_ != no_deadline) {
        if (registration_.is_stopped()) {
            stopped_ = no_deadline;
            registration_.start_again(now);
        } else if (now - stopped_ > 1min) {
            violation("a farewell has no end");
            stopped_ = now;
        }
        return;
    }
    if (may_leave_ && chance_.one_in(100)) {
        registration_.stop(now);
        stopped_ = now;
        return;
    }
    if (registration_.next_deadline() <= now + 3min) {
        planned_ = now;
    } else if (now - planned_ > 1min) { // longer than the connection takes to close
        violation("the next attempt never comes");
        planned_ = now;
    }
}

void RegistrationWatch::check_recovery()
{
    if (!registration_.is_registered()) {
        violation("is not registered");
    }
    may_leave_ = true;
}

} // namespace busbar::test
