#pragma once

#include <algorithm>
#include <vector>

#include "fuzz_script.hpp"
#include "support/channel_pair.hpp"

namespace busbar::fuzz {

/// Sign or SignAndEncrypt, as the next byte says.
[[nodiscard]] inline channel::SecuritySetting secured(Script& script)
{
    return test::setting("Basic256Sha256", script.byte() % 2 == 0
                                               ? MessageSecurityMode::Sign
                                               : MessageSecurityMode::SignAndEncrypt);
}

template <typename Pair>
void send(Pair& pair, Script& script)
{
    const std::size_t size = script.byte() * std::size_t{script.byte()};
    static_cast<void>(pair.client.send([&](binary::Writer& writer) {
        writer.bytes(script.bytes(size / 2));
        for (std::size_t i = 0; i < size && writer.ok(); ++i) {
            writer.number(static_cast<std::uint8_t>(i));
        }
    }));
}

/// What the client has to send, changed as the script says.
template <typename Pair>
std::vector<std::byte> changed(Pair& pair, Script& script)
{
    std::vector<std::byte> bytes{pair.client.output().begin(), pair.client.output().end()};
    pair.client.consume(bytes.size());
    switch (script.byte() % 4) {
    case 0: {
        for (std::size_t i = script.byte() % 4; i != 0 && !bytes.empty(); --i) {
            const std::size_t at = script.byte() + std::size_t{script.byte()} * 256;
            bytes[at % bytes.size()] ^= static_cast<std::byte>(script.byte());
        }
        break;
    }
    case 1:
        bytes.resize(std::min<std::size_t>(bytes.size(), script.byte()));
        break;
    case 2:
        bytes.insert(bytes.end(), bytes.begin(), bytes.end());
        break;
    default: {
        const auto raw = script.bytes(script.byte());
        bytes.insert(bytes.end(), raw.begin(), raw.end());
    }
    }
    return bytes;
}

template <typename Pair>
void poll(Pair& pair)
{
    while (pair.server.next_event()) {
    }
    pair.server.consume(pair.server.output().size());
}

/// Lets `script` play both a well-behaved and a hostile client on an open channel, of a ChannelPair
/// or a PreparedPair: messages are sent as they are, with bytes changed, cut, repeated or replaced
/// by raw input; time passes.
template <typename Pair>
void play(Pair& pair, Script& script)
{
    for (int step = 0; step < 24 && !script.is_over() && !pair.server.is_closed(); ++step) {
        switch (script.byte() % 6) {
        case 0:
            send(pair, script);
            pair.run();
            break;
        case 1:
            send(pair, script);
            static_cast<void>(pair.server.feed(changed(pair, script), pair.now));
            poll(pair);
            break;
        case 2:
            static_cast<void>(pair.server.feed(script.bytes(script.byte()), pair.now));
            poll(pair);
            break;
        case 3:
            pair.advance(std::chrono::seconds{script.byte() % 64});
            break;
        case 4:
            static_cast<void>(pair.server.send(script.byte(), [&](binary::Writer& writer) {
                writer.bytes(script.bytes(script.byte()));
            }));
            pair.run();
            break;
        default:
            pair.client.close();
            pair.run();
        }
        pair.server_events.clear();
        pair.client_events.clear();
    }
}

} // namespace busbar::fuzz
