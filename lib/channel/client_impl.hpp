#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/channel/client_channel.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"
#include "event_queue.hpp"

namespace busbar::channel {

namespace detail {

enum class ClientChannelState : std::uint8_t { ReverseHello, Acknowledge, Opening, Open, Closed };

} // namespace detail

/// The implementation of a ClientChannel: client_channel.cpp has the connection, client_open.cpp
/// requests and takes SecurityTokens.
struct ClientChannel::Impl {
    using State = detail::ClientChannelState;

    Impl(ClientChannelConfig c, const ChannelEnvironment& environment, TimePoint start)
        : config{std::move(c)}, conversation{config.limits, environment, detail::Role::Client},
          now{start}, handshake_deadline{start + config.limits.handshake_timeout}
    {
        conversation.security = config.security;
    }

    void say_hello();
    [[nodiscard]] Checked<void> handle(const detail::Frame& frame);
    [[nodiscard]] Checked<void> handle_reverse_hello(const detail::Frame& frame);
    void handle_error(const detail::Frame& frame);
    [[nodiscard]] Checked<void> handle_acknowledge(const detail::Frame& frame);
    [[nodiscard]] Checked<void> handle_open(const detail::Frame& frame);
    [[nodiscard]] Checked<void> handle_message(const detail::Frame& frame);
    [[nodiscard]] Result<void> request_token(SecurityTokenRequestType type);
    [[nodiscard]] Checked<detail::AsymmetricContent> open_response(const detail::Frame& frame);
    [[nodiscard]] Checked<void> check_server(const detail::AsymmetricHeader& header);
    [[nodiscard]] Checked<void> take_token(const OpenSecureChannelResponse& response);
    [[nodiscard]] std::uint32_t next_request_id();
    void send_close();
    void give_up(const Refusal& refusal);
    void end(StatusCode status, std::string reason);

    ClientChannelConfig config;
    detail::Conversation conversation;
    State state{State::Acknowledge};
    TimePoint now;
    TimePoint handshake_deadline;
    std::uint32_t last_request_id{0};
    std::uint32_t open_request_id{0}; // 0 while no OPN is under way
    crypto::Secret nonce;
    ByteString server_nonce; // from the last OpenSecureChannel
    detail::PendingEvents events;
};

} // namespace busbar::channel
