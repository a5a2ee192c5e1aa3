#include "quotas.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <thread>
#include <utility>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/types/session.hpp>
#include <busbar/types/subscription.hpp>

#include "socket.hpp"

namespace busbar::bench {

namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds quota_patience{10'000};
/// Between two attempts of one that is refused.
constexpr std::chrono::milliseconds short_pause{1};
/// Connections that one attacker keeps, so that 20 want all that a server has by far.
constexpr std::size_t kept = 16;
/// Bytes of a message that is begun, and what is missing of it.
constexpr std::size_t unfinished_size = 15U << 20U;
constexpr std::size_t smallest_size = 2'048;
constexpr std::size_t end_size = 100;

/// Opens connections for ever and keeps the last ones.
template <typename Open>
void keep_open(Tally& tally, Open open)
{
    std::vector<decltype(open())> held(kept);
    for (std::size_t i = 0; !tally.is_over; i = (i + 1) % kept) {
        held[i] = {};
        held[i] = open();
        ++(held[i] ? tally.answered : tally.refused);
        if (!held[i]) {
            std::this_thread::sleep_for(short_pause);
        }
    }
}

std::unique_ptr<net::ClientLoop> session_of(Load& load)
{
    auto loop = std::make_unique<net::ClientLoop>();
    return load.open(*loop, true, quota_patience) ? std::move(loop) : nullptr;
}

/// Sessions whose connections end without CloseSession.
void take_sessions(Load& load, Tally& tally)
{
    keep_open(tally, [&] { return session_of(load); });
}

/// As many Subscriptions as the server gives to one session.
void fill_session(net::ClientLoop& loop, Tally& tally)
{
    CreateSubscriptionRequest request;
    request.requested_publishing_interval = 10;
    request.requested_lifetime_count = 1'000'000'000;
    request.requested_max_keep_alive_count = 1'000'000;
    request.publishing_enabled = true;
    while (!tally.is_over) {
        const auto event = loop.call(request);
        if (!event || event->status.is_bad()) {
            ++tally.refused;
            return;
        }
        ++tally.answered;
    }
}

/// They live on without the session, and nobody asks for what they have.
void leave_subscriptions(Load& load, Tally& tally)
{
    while (!tally.is_over) {
        const auto loop = session_of(load);
        if (!loop) {
            ++tally.refused;
            std::this_thread::sleep_for(short_pause);
            continue;
        }
        fill_session(*loop, tally);
        CloseSessionRequest request;
        request.delete_subscriptions = false;
        static_cast<void>(loop->call(request));
    }
}

std::unique_ptr<Socket> socket_to(const Load& load)
{
    const auto url = channel::EndpointUrl::parse(load.url());
    if (!url) {
        return nullptr;
    }
    const Peer peer{url->host, std::to_string(url->port)};
    if (peer.address() == nullptr) {
        return nullptr;
    }
    auto socket = std::make_unique<Socket>(peer.address()->ai_family);
    return socket->connect({}, *peer.address()) ? std::move(socket) : nullptr;
}

void say_nothing(const Load& load, Tally& tally)
{
    keep_open(tally, [&] { return socket_to(load); });
}

/// Gives what the channel wants to send to the server, and the server's answer to the channel.
bool exchange(const Socket& socket, channel::ClientChannel& channel)
{
    const auto out = channel.output();
    std::array<std::byte, 4'096> room;
    if (!socket.send(out)) {
        return false;
    }
    channel.consume(out.size());
    const std::size_t size = socket.receive(room);
    if (size == 0 || !channel.feed(std::span{room}.first(size), clock_now())) {
        return false;
    }
    while (channel.next_event()) {
    }
    return true;
}

/// The chunks of a message of that size without its end, which the server has to wait for.
bool send_beginning(const Socket& socket, channel::ClientChannel& channel, std::size_t size)
{
    static constexpr std::array<std::byte, 1'024> part{};
    const auto sent = channel.send([size](binary::Writer& writer) {
        for (std::size_t i = 0; i < size; i += part.size()) {
            writer.bytes(part);
        }
    });
    return sent && socket.send(channel.output().first(channel.output().size() - end_size));
}

/// A message without an end, until the server does something about it; at once if it is too large.
bool hold_beginning(Load& load, Tally& tally, std::size_t size)
{
    const auto socket = socket_to(load);
    auto channel = load.make_channel();
    if (!socket || !exchange(*socket, channel) || !exchange(*socket, channel) ||
        !send_beginning(*socket, channel, size) || socket->has_news()) {
        return false;
    }
    while (!tally.is_over && !socket->has_news()) {
    }
    return true;
}

/// Messages that have no end, as large as the server takes them.
void never_finish(Load& load, Tally& tally)
{
    for (std::size_t size = unfinished_size; !tally.is_over;) {
        if (hold_beginning(load, tally, size)) {
            ++tally.answered;
            continue;
        }
        ++tally.refused;
        size = std::max(size / 2, smallest_size);
    }
}

void guess_passwords(Load& load, Tally& tally)
{
    while (!tally.is_over) {
        ++(session_of(load) ? tally.answered : tally.refused);
    }
}

} // namespace

std::vector<Attack> quota_attacks(Load& strangers, Load& guessers,
                                  const std::vector<std::size_t>& attackers)
{
    std::vector<Attack> attacks;
    for (const std::size_t count : attackers) {
        const auto add = [&](const std::string& name, auto what) {
            attacks.push_back({std::to_string(count) + " " + name, count,
                               [=](Tally& tally, std::size_t) { what(tally); }});
        };
        add("take sessions", [&strangers](Tally& tally) { take_sessions(strangers, tally); });
        add("leave Subscriptions",
            [&strangers](Tally& tally) { leave_subscriptions(strangers, tally); });
        add("never finish", [&strangers](Tally& tally) { never_finish(strangers, tally); });
        add("say nothing", [&strangers](Tally& tally) { say_nothing(strangers, tally); });
        add("guess passwords", [&guessers](Tally& tally) { guess_passwords(guessers, tally); });
    }
    return attacks;
}

} // namespace busbar::bench
