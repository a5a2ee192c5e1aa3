#include "library_client.hpp"

#include <utility>

#include "support/identity.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

/// InfoType DataValue and Overflow (Part 4, 7.38.1).
constexpr std::uint32_t overflow_bits = 0x0480;

client::ClientConfig library_config()
{
    client::ClientConfig config;
    config.endpoint_url = "opc.tcp://localhost:4840";
    config.application_uri = "urn:busbar:test:client";
    config.identity = client::NamedUser{"program", "program-secret"};
    config.session_timeout = 15min;
    config.keep_alive_interval = 30s;
    return config;
}

client::SubscriptionSettings settings_of(std::chrono::milliseconds interval)
{
    client::SubscriptionSettings settings;
    settings.publishing_interval = interval;
    settings.max_keep_alive_count = static_cast<std::uint32_t>(20s / interval);
    settings.lifetime_count = static_cast<std::uint32_t>(30min / interval);
    return settings;
}

} // namespace

LibraryClient::LibraryClient(World& world, const Plant& plant, Trace& trace, std::size_t number)
    : world_{world}, plant_{plant}, trace_{trace}, number_{number},
      host_{world, library_config(), {.identity = &client_identity(), .log = &log_}}
{
}

void LibraryClient::start()
{
    subscribe(settings_of(250ms), Plant::Kind::Storm, 4);
    for (std::size_t i = 2; i < publish_requests; ++i) { // the Client adds one request
        subscribe(settings_of(5s), Plant::Kind::Memory, 2);
    }
    host_.client().connect(world_.now());
}

void LibraryClient::subscribe(const client::SubscriptionSettings& settings, Plant::Kind kind,
                              std::size_t counters)
{
    client::SubscriptionHandlers handlers;
    handlers.on_data = [this](auto changes) { receive(changes); };
    handlers.on_gap = [this](const client::Gap& gap) { refuse_gap(gap); };
    client::Subscriptions& all = host_.client().subscriptions();
    const auto subscription = all.create(settings, std::move(handlers));
    std::vector<client::ItemSettings> items(counters);
    for (std::size_t i = 0; i < counters; ++i) {
        items[i].node = plant_.node(kind, i);
        items[i].sampling_interval = kind == Plant::Kind::Storm ? 0ms : 5'000ms;
        items[i].queue_size = 50;
    }
    const auto added = all.add_items(*subscription, std::move(items));
    for (std::size_t i = 0; i < counters; ++i) {
        watches_.emplace((*added)[i], Watch{kind, i, {}});
    }
    subscriptions_.emplace(*subscription, *added);
}

void LibraryClient::receive(std::span<const client::DataChange> changes)
{
    trace_.note(number_, "values", changes.size());
    for (const client::DataChange& change : changes) {
        Watch& watch = watches_.at(change.item);
        const std::uint32_t status = change.value.status.value();
        if ((status & overflow_bits) == overflow_bits) {
            watch.check.tell_overflow();
        }
        const auto last = watch.check.last();
        const std::int64_t number = change.value.value.value_or<std::int32_t>(-1);
        if (number < 0 || !watch.check.receive(number)) {
            violation("item " + std::to_string(change.item) + ": " + std::to_string(number) +
                      " after " + (last ? std::to_string(*last) : "nothing"));
        }
    }
}

/// Its lifetime is longer than what any connection is away and the server without memory.
void LibraryClient::refuse_gap(const client::Gap& gap)
{
    trace_.note(number_, "gap", gap.reason.value());
    violation("a gap: " + std::string{name(gap.reason)});
}

void LibraryClient::check_arrivals()
{
    if (host_.state() != client::ClientState::Ready) {
        violation("is not back");
    }
    for (const auto& [item, watch] : watches_) {
        const std::int64_t count = plant_.count(watch.kind, watch.counter);
        if (watch.check.last() != count) {
            violation("item " + std::to_string(item) + " did not bring the last of " +
                      std::to_string(count));
        }
    }
}

void LibraryClient::leave()
{
    for (const auto& [subscription, items] : subscriptions_) {
        static_cast<void>(host_.client().subscriptions().remove(subscription));
    }
    subscriptions_.clear();
    watches_.clear();
    host_.client().close(world_.now());
}

} // namespace busbar::test
