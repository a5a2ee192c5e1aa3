#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <busbar/channel/server_channel.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"
#include "event_queue.hpp"
#include "open_work.hpp"

namespace busbar::channel {

namespace detail {

enum class ServerChannelState : std::uint8_t { Hello, Opening, Open, Closed };

} // namespace detail

/// The implementation of a ServerChannel: server_channel.cpp has the connection, server_open.cpp
/// issues SecurityTokens, server_work.cpp uses an OpenWorker for that.
struct ServerChannel::Impl {
    using State = detail::ServerChannelState;

    Impl(ServerChannelConfig c, const ChannelEnvironment& environment, TimePoint start)
        : config{std::move(c)}, conversation{config.limits, environment, detail::Role::Server,
                                             config.spares},
          now{start}, handshake_deadline{start + config.limits.handshake_timeout}
    {
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl()
    {
        report_failure();
        drop_work();
    }

    /// Releases a held message whose time has come.
    void advance(TimePoint time);
    [[nodiscard]] Checked<void> handle(const detail::Frame& frame);
    [[nodiscard]] Checked<void> handle_hello(const detail::Frame& frame);
    [[nodiscard]] Checked<void> handle_open(const detail::Frame& frame);
    /// True if the asymmetric work for a message with these headers may be done now; else the
    /// message is held.
    [[nodiscard]] Checked<bool> has_turn(const detail::Frame& frame,
                                         const detail::AsymmetricHeader& header);
    /// The peer has proved that it has the keys.
    void prove();
    /// Reports wasted work to the gate.
    void report_failure();
    [[nodiscard]] Checked<void> handle_message(const detail::Frame& frame);
    void take_over(detail::OpenRequest& request);
    /// Creates the next SecurityToken and the response for the peer.
    [[nodiscard]] Result<detail::OpenAnswer> make_answer(OpenSecureChannelRequest request);
    /// Sends the answer.
    [[nodiscard]] Result<void> issue(detail::OpenAnswer answer, std::uint32_t request_id);
    /// Uses the token, once the answer is on its way.
    void put_in_force(detail::OpenAnswer answer);

    // With an OpenWorker; the input is held while it works.

    [[nodiscard]] bool has_worker_for(const crypto::SecurityPolicy& policy) const;
    [[nodiscard]] Checked<void> hand_over_request(const detail::Frame& frame,
                                                  const detail::AsymmetricHeader& header);
    [[nodiscard]] Checked<void> hand_over_answer(detail::OpenAnswer answer,
                                                 ApplicationIdentity identity,
                                                 std::uint32_t request_id);
    [[nodiscard]] Checked<void> hand_over(std::shared_ptr<OpenWork> work);
    [[nodiscard]] OpenWork::Kind kind_of_work(OpenWork::Kind of_new_channel) const;
    void work_done(StatusCode status);
    [[nodiscard]] Checked<void> request_opened(detail::OpeningWork& work);
    [[nodiscard]] Checked<void> answer_sealed(const detail::SealingWork& work,
                                              detail::OpenAnswer answer);
    void drop_work();

    void give_up(const Refusal& refusal);
    void fail_with(StatusCode told_status, StatusCode status, std::string_view reason);
    void end(StatusCode status, std::string reason);

    ServerChannelConfig config;
    detail::Conversation conversation;
    State state{State::Hello};
    TimePoint now;
    TimePoint handshake_deadline;
    std::string endpoint_url;
    std::uint32_t last_token_id{0};
    ByteString client_nonce;
    bool is_reverse{false};
    /// The time when the held message is released.
    TimePoint turn{no_deadline};
    /// A request that the gate has admitted is not answered yet.
    bool is_at_work{false};
    /// The channel is new, and its peer has not proved that it has the keys.
    bool is_unproven{false};
    /// The log has already been told of similar refusals.
    bool is_refusal_known{false};
    detail::OpenProgress progress;
    detail::PendingEvents events;
};

} // namespace busbar::channel
