#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "channel/conversation.hpp"
#include "channel/open_work.hpp"
#include "support/channel_pair.hpp"

namespace busbar::fuzz {

/// What both sides said until a channel was open, and what they found out by RSA: who says the same
/// again with the same random numbers needs none.
struct Handshake {
    channel::SecuritySetting security;
    std::vector<std::byte> client_bytes;
    channel::detail::AsymmetricContent request;
    std::vector<std::byte> answer;
    OpenSecureChannelResponse response;
    ByteString client_nonce;

    /// Of this setting, which is not None; made when it is asked for the first time.
    [[nodiscard]] static const Handshake& of(const channel::SecuritySetting& security);
};

/// The client's end of a channel that is open: sends what it is told, and verifies what comes.
class PreparedClient {
public:
    PreparedClient(const Handshake& handshake, const channel::ChannelEnvironment& environment,
                   TimePoint now);

    Result<void> send(FunctionRef<void(binary::Writer&)> encode);
    void close();
    [[nodiscard]] std::span<const std::byte> output() const
    {
        return conversation_.output().output();
    }
    void consume(std::size_t size) { conversation_.output().consume(size); }
    /// All that came is whole chunks that the server has secured, or an Error message.
    void take(std::span<const std::byte> bytes, TimePoint now);

private:
    channel::detail::Conversation conversation_;
    std::uint32_t request_id_{1};
};

/// A ChannelPair whose handshake costs nothing. Its client asks for no other SecurityToken.
class PreparedPair {
public:
    explicit PreparedPair(const channel::SecuritySetting& security);

    void run();
    void advance(Duration time);

    test::SeededRandom random;
    test::FixedWallClock wall_clock;
    NullLog log;
    crypto::InsecureAcceptAnyCertificate validator;
    test::HandWorker worker;
    TimePoint now{};
    std::vector<channel::ChannelEvent> server_events;
    std::vector<channel::ChannelEvent> client_events;
    channel::ServerChannel server;
    PreparedClient client;
};

} // namespace busbar::fuzz
