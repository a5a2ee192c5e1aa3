#include "silence_watch.hpp"

#include <algorithm>
#include <utility>

#include <busbar/client/attributes.hpp>
#include <busbar/client/discovery.hpp>
#include <busbar/client/methods.hpp>
#include <busbar/client/resolve_nodes.hpp>
#include <busbar/client/view.hpp>
#include <busbar/core/text.hpp>

namespace busbar::test {

using namespace std::chrono_literals;
using client::ClientState;

namespace {

constexpr std::size_t item_count = 3;
/// Within an attempt: connect_timeout, for the second endpoint again, and the longest pause.
constexpr Duration longest_state = 90s;
/// Ten keep-alive intervals of 25 s with half as much for each, and the pauses after failures.
constexpr Duration longest_silence = 10min;

client::ClientConfig watch_config()
{
    client::ClientConfig config = harness::open_client_config();
    config.endpoint_url = "opc.tcp://moody:4840";
    config.session_timeout = 2min;
    config.keep_alive_interval = 20s;
    config.channel_lifetime = 10min;
    return config;
}

} // namespace

SilenceWatch::SilenceWatch(World& world, MoodyServer& server, Trace& trace)
    : world_{world}, server_{server}, trace_{trace},
      chance_{world.new_chance(harness::Actor::Other)}, host_{world, watch_config(), {.log = &log_}}
{
    client().on_state([this](ClientState state, StatusCode why) {
        trace_.note(0, "state", static_cast<std::uint64_t>(state), why.value());
        state_since_ = world_.now();
        connections_ += state == ClientState::Ready ? 1 : 0;
        for (std::size_t i = 0; i < watched_.size(); ++i) {
            tell(i);
        }
    });
    types_.emplace(client());
    watched_.resize(2);
    for (std::size_t i = 0; i < watched_.size(); ++i) {
        watched_[i].settings.publishing_interval = i == 0 ? 2s : 5s;
        watched_[i].settings.max_keep_alive_count = 5;
        subscribe(i);
    }
    client().connect(world_.now());
}

void SilenceWatch::subscribe(std::size_t index)
{
    client::SubscriptionHandlers handlers;
    handlers.on_data = [this, index](std::span<const client::DataChange> changes) {
        tell(index);
        values_ += changes.size();
        for (const client::DataChange& change : changes) {
            const auto found = watched_[index].items.find(change.item);
            if (found != watched_[index].items.end() && !change.value.status.is_bad()) {
                found->second.last_value = world_.now();
            }
        }
    };
    handlers.on_gap = [this, index](const client::Gap& gap) {
        trace_.note(index + 1, "gap", gap.reason.value());
        tell(index);
    };
    handlers.on_status = [this, index](StatusCode status, auto, const auto&) {
        trace_.note(index + 1, "status", status.value());
        tell(index);
    };
    handlers.on_item = [this, index](client::ItemHandle item, const client::ItemStatus& status) {
        tell(index);
        const auto found = watched_[index].items.find(item);
        if (found != watched_[index].items.end()) {
            found->second.has_failed = status.status.is_bad();
        }
    };
    Watched& watched = watched_[index];
    watched.handle = client().subscriptions().create(watched.settings, std::move(handlers)).value();
    add_items(watched, item_count);
}

void SilenceWatch::add_items(Watched& watched, std::size_t count)
{
    std::vector<client::ItemSettings> settings(count);
    for (std::size_t i = 0; i < count; ++i) {
        settings[i].node = NodeId{1, static_cast<std::uint32_t>(i + 1)};
    }
    const auto added = client().subscriptions().add_items(watched.handle, std::move(settings));
    for (const client::ItemHandle each : added.value()) {
        watched.items[each] = {};
    }
}

void SilenceWatch::violation(const std::string& what)
{
    trace_.violation(0, what + " [" + server_.ailments() + "]");
}

void SilenceWatch::begin(const char* name, Duration limit,
                         const std::function<client::Operation(std::function<void()>)>& start)
{
    Waiting& waiting = waiting_.emplace_back();
    waiting.name = name;
    waiting.until = world_.now() + limit;
    waiting.operation = start([this, &waiting] {
        waiting.has_ended = true;
        ++ended_;
    });
}

void SilenceWatch::begin_one()
{
    client::Requester& at = client();
    const NodeId node{1, 1U};
    const auto tree = [&](auto done) {
        client::TreeLimits limits;
        limits.max_nodes = 50;
        limits.browse.max_references = 100;
        return client::browse_tree(
            at, {node}, client::children_of(node), [done](const auto&) { done(); }, limits);
    };
    switch (chance_.below(9)) {
    case 0:
        return begin("a Read", 1min, [&](auto done) {
            return client::read(at, {client::attribute_of(node)}, [done](const auto&) { done(); });
        });
    case 1:
        return begin("a Write", 1min, [&](auto done) {
            return client::write(at, {WriteValue{}}, [done](const auto&) { done(); });
        });
    case 2:
        return begin("a Call", 1min, [&](auto done) {
            return client::call(at, {CallMethodRequest{node, node, {}}},
                                [done](const auto&) { done(); });
        });
    case 3:
        // Each level may take all the time that a request has.
        return begin("browsing a tree", 30min, tree);
    case 4:
        return begin("finding a path", 5min, [&](auto done) {
            const auto path = client::NodeAddress::path("/Objects/1:Machine").value();
            return client::resolve_nodes(at, {path}, [done](const auto&) { done(); });
        });
    case 5:
        return begin("RegisterNodes", 1min, [&](auto done) {
            return client::register_nodes(at, {node}, [done](const auto&) { done(); });
        });
    case 6:
        return begin("UnregisterNodes", 1min, [&](auto done) {
            return client::unregister_nodes(at, {node}, [done](const auto&) { done(); });
        });
    case 7:
        return begin("FindServers", 1min, [&](auto done) {
            client::find_servers(at, "opc.tcp://moody:4840", [done](const auto&) { done(); });
            return client::Operation{};
        });
    default:
        return begin("learning a type", 10min, [&](auto done) {
            return types_->learn({NodeId{1, static_cast<std::uint32_t>(chance_.below(1'000))}},
                                 done);
        });
    }
}

/// Other settings of a Subscription, its items or its links, with which values still come.
void SilenceWatch::change_wishes()
{
    Watched& watched = watched_[chance_.below(watched_.size())];
    client::Subscriptions& subscriptions = client().subscriptions();
    std::vector<client::ItemHandle> items;
    for (const auto& [handle, item] : watched.items) {
        items.push_back(handle);
    }
    switch (chance_.below(3)) {
    case 0:
        watched.settings.publishing_interval = chance_.between(1s, 6s);
        static_cast<void>(subscriptions.modify(watched.handle, watched.settings));
        break;
    case 1: {
        client::ItemSettings settings;
        settings.sampling_interval = chance_.between(100ms, 5s);
        static_cast<void>(subscriptions.modify_items(items, settings));
        break;
    }
    default:
        if (items.size() > 1) {
            static_cast<void>(subscriptions.set_triggering(items[0], {items[1]}));
        }
    }
}

void SilenceWatch::act()
{
    if (waiting_.size() < 20) {
        begin_one();
    }
    if (chance_.one_in(5)) {
        change_wishes();
    }
    if (chance_.one_in(50) && !user_change_) {
        user_change_ = world_.now();
        client().change_user(client::AnonymousUser{}, [this](StatusCode) { user_change_.reset(); });
    }
    if (chance_.one_in(200)) {
        client().close(world_.now(), chance_.one_in(2));
    }
    if (host_.state() == ClientState::Closed) { // which it has told
        client().connect(world_.now());
    }
}

void SilenceWatch::check()
{
    const TimePoint now = world_.now();
    for (const Waiting& each : waiting_) {
        if (!each.has_ended && now > each.until) {
            violation(each.name + " has no end");
        }
    }
    std::erase_if(waiting_,
                  [&](const Waiting& each) { return each.has_ended || now > each.until; });
    if (user_change_ && now - *user_change_ > 1min) {
        violation("a change of user has no end");
        user_change_.reset();
    }
    const ClientState state = host_.state();
    if (state == ClientState::Closed) {
        return;
    }
    if (state != ClientState::Ready) {
        if (now - state_since_ > longest_state) {
            violation("state " + std::to_string(static_cast<int>(state)) + " does not end");
            state_since_ = now;
        }
    }
    if (client().next_deadline() == no_deadline) {
        violation("no deadline in state " + std::to_string(static_cast<int>(state)));
    }
    for (Watched& each : watched_) {
        const std::uint32_t id = client().subscriptions().server_id(each.handle);
        if (now - std::max(each.told, server_.last_message(id)) > longest_silence) {
            violation("nothing is heard of Subscription " + std::to_string(id) + " in state " +
                      std::to_string(static_cast<int>(state)) + ", mode " +
                      std::to_string(static_cast<int>(client().subscriptions().mode(each.handle))));
            each.told = now;
        }
    }
}

void SilenceWatch::begin_recovery()
{
    if (host_.state() == ClientState::Closed) {
        client().connect(world_.now());
    }
    for (Watched& each : watched_) {
        std::vector<client::ItemHandle> failed;
        for (const auto& [handle, item] : each.items) {
            if (item.has_failed) {
                failed.push_back(handle);
            }
        }
        for (const client::ItemHandle handle : failed) {
            each.items.erase(handle);
        }
        if (!failed.empty()) {
            static_cast<void>(client().subscriptions().remove_items(failed));
            add_items(each, failed.size());
        }
    }
}

void SilenceWatch::check_recovery()
{
    if (host_.state() != ClientState::Ready) {
        violation("is not back: state " + std::to_string(static_cast<int>(host_.state())) + ", " +
                  std::string{name(client().last_error())});
    }
    for (const Watched& each : watched_) {
        for (const auto& [handle, item] : each.items) {
            if (item.has_failed) {
                continue; // told after the beginning: of a request that began before it
            }
            if (world_.now() - item.last_value > 1min) {
                const auto age = std::chrono::duration<double>{world_.now() - item.last_value};
                violation(
                    "item " + std::to_string(handle) + " has no value since " +
                    std::to_string(age.count()) + " s, Subscription " +
                    std::to_string(client().subscriptions().server_id(each.handle)) + ", mode " +
                    std::to_string(static_cast<int>(client().subscriptions().mode(each.handle))));
            }
        }
    }
}

void SilenceWatch::leave()
{
    for (const Watched& each : watched_) {
        static_cast<void>(client().subscriptions().remove(each.handle));
    }
    client().close(world_.now());
    world_.run_for(30s);
    if (host_.state() != ClientState::Closed) {
        violation("is not closed");
    }
    for (const Waiting& each : waiting_) {
        if (!each.has_ended) {
            violation(each.name + " has no end though it was closed");
        }
    }
    waiting_.clear();
}

} // namespace busbar::test
