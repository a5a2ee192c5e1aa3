#include "attacker.hpp"

#include <algorithm>
#include <utility>

#include <busbar/types/ids.hpp>
#include <busbar/types/subscription.hpp>
#include <busbar/types/view.hpp>

#include "support/effort.hpp"

namespace busbar::test {

using namespace std::chrono_literals;

namespace {

/// Sockets and connections at a time. With sessions there are fewer: who may log in may keep a
/// place for himself.
constexpr std::size_t max_sockets = 80;
constexpr std::size_t max_ports = 40;
constexpr std::size_t max_insider_ports = 8;

} // namespace

Attacker::Attacker(const HostileParts& parts, std::size_t number, Chance chance)
    : parts_{parts}, number_{number}, chance_{chance},
      address_{"198.51.100." + std::to_string(number)}, act_{parts.scheduler, [this] { act(); }}
{
}

void Attacker::start()
{
    act_.set_after(chance_.between(10s, 5min));
}

void Attacker::leave()
{
    act_.cancel();
    acts_ = 0;
    drop_all();
}

void Attacker::drop_all()
{
    sockets_.clear();
    ports_.clear();
    recorded_->clear();
}

void Attacker::begin()
{
    // Each way at once, so that tables have the size of their fullest moment; then as it comes.
    const std::size_t way = tried_ < ways ? (number_ + tried_) % ways : chance_.below(ways);
    ++tried_;
    way_ = static_cast<Way>(way);
    acts_ = static_cast<int>(10 + chance_.below(40));
    parts_.trace.note(number_, "attacks", static_cast<std::uint64_t>(way_));
    if (way_ == Way::Replay) {
        record_channel();
    }
}

void Attacker::act()
{
    if (acts_ == 0) {
        begin();
    }
    std::erase_if(sockets_, [](const auto& socket) { return socket->has_ended(); });
    std::erase_if(ports_, [](const auto& port) { return port->has_ended(); });
    switch (way_) {
    case Way::Silence:
        for (int i = 0; i < 20; ++i) {
            open_socket({});
        }
        break;
    case Way::OpenMessages:
        withhold();
        break;
    case Way::Replay:
        open_socket(*recorded_);
        break;
    case Way::Sessions:
        flood_sessions();
        break;
    case Way::Subscriptions:
        flood_subscriptions();
        break;
    case Way::Browse:
        flood_browse();
        break;
    case Way::Logins:
        guess_passwords();
        break;
    case Way::Garbage:
        open_socket(garbage());
        break;
    }
    if (--acts_ == 0) {
        drop_all();
        act_.set_after(tried_ < ways ? chance_.between(1min, 3min) : chance_.between(30min, 3h));
    } else {
        act_.set_after(chance_.between(100ms, 10s));
    }
}

void Attacker::open_socket(const std::vector<std::byte>& bytes)
{
    if (sockets_.size() < max_sockets) {
        sockets_.push_back(std::make_unique<HostileSocket>(parts_, address_,
                                                           Chance{chance_.next(), number_}, bytes));
    }
}

void Attacker::open_port(HostilePort::Then then)
{
    if (ports_.size() < max_ports) {
        ports_.push_back(std::make_unique<HostilePort>(
            parts_, address_, Chance{chance_.next(), number_}, std::move(then)));
    }
}

void Attacker::record_channel()
{
    ports_.push_back(std::make_unique<HostilePort>(
        parts_, address_, Chance{chance_.next(), number_},
        [](HostilePort& port) { port.tampering()->record = nullptr; }, recorded_));
}

void Attacker::withhold()
{
    open_port([this](HostilePort& port) {
        port.tampering()->withholds = true;
        BrowseRequest request;
        request.nodes_to_browse.resize(1 + chance_.below(1'000));
        port.send<BrowseResponse>(request);
    });
}

void Attacker::flood_sessions()
{
    for (int i = 0; i < 5; ++i) {
        open_port([](HostilePort& port) {
            for (int k = 0; k < 10; ++k) {
                port.create_session([](const auto&) {});
            }
        });
    }
}

void Attacker::flood_subscriptions()
{
    if (ports_.size() >= max_insider_ports) {
        ports_.clear(); // the Subscriptions stay
    }
    const std::string name = "user" + std::to_string(number_);
    open_port([name](HostilePort& port) {
        port.log_in(name, name + "-secret", [](HostilePort& session) {
            for (int i = 0; i < 50; ++i) {
                CreateSubscriptionRequest request;
                request.requested_publishing_interval = 60'000;
                request.requested_max_keep_alive_count = 10;
                request.requested_lifetime_count = 60;
                request.publishing_enabled = true;
                session.send<CreateSubscriptionResponse>(request);
            }
        });
    });
}

void Attacker::flood_browse()
{
    if (ports_.size() >= max_insider_ports) {
        return;
    }
    const std::string name = "user" + std::to_string(number_);
    // Most of the time of a short run would be for their answers.
    const std::size_t nodes = is_full_effort() ? 5 : 1;
    open_port([name, nodes](HostilePort& port) {
        port.log_in(name, name + "-secret", [nodes](HostilePort& session) {
            BrowseRequest request;
            request.nodes_to_browse.resize(nodes);
            for (BrowseDescription& node : request.nodes_to_browse) {
                node.node_id = NodeId{0, id::Server};
                node.result_mask = 63;
            }
            for (int i = 0; i < 100; ++i) {
                session.send<BrowseResponse>(request);
            }
        });
    });
}

void Attacker::guess_passwords()
{
    const std::string name = "user" + std::to_string(1 + chance_.below(parts_.others));
    open_port([name](HostilePort& port) {
        for (int i = 0; i < 3; ++i) {
            port.log_in(name, "guessed", [](HostilePort&) {});
        }
    });
}

std::vector<std::byte> Attacker::garbage()
{
    // A header that may be right, so that what follows is looked at.
    static constexpr char kinds[] = "HELFOPNFMSGFMSGCCLOFERRFRHEFXXXX";
    std::vector<std::byte> bytes(8 + chance_.below(2'000));
    for (std::byte& byte : bytes) {
        byte = static_cast<std::byte>(chance_.next() & 0xFFU);
    }
    const std::size_t kind = 4 * chance_.below(8);
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[i] = static_cast<std::byte>(kinds[kind + i]);
    }
    if (chance_.one_in(2)) {
        bytes[4] = static_cast<std::byte>(bytes.size() & 0xFFU);
        bytes[5] = static_cast<std::byte>(bytes.size() >> 8U);
        bytes[6] = bytes[7] = std::byte{0};
    }
    return bytes;
}

} // namespace busbar::test
