#pragma once

#include <cstdint>
#include <optional>

#include <busbar/channel/server_channel.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/types/secure_channel.hpp>

#include "conversation.hpp"

namespace busbar::channel::detail {

/// An OpenSecureChannel request that was decrypted, verified and accepted.
struct OpenRequest {
    SecuritySetting security;
    crypto::CertificateChain sender;
    std::uint32_t request_id{0};
    OpenSecureChannelRequest body;
};

/// The sender of an OPN.
struct OpenSender {
    crypto::CertificateChain certificates; // none with policy None
    std::optional<Refusal> objection;      // from the validator
};

/// The server's state when an OPN arrives.
struct OpenContext {
    const ServerChannelConfig& config;
    bool is_renewal{false};       // the channel is open
    const ByteString& last_nonce; // the client's, from the previous request
};

/// Makes the checks that cost nothing: the headers are those of a message to this channel, with an
/// offered policy and for the certificate of this server. The result points into the frame.
[[nodiscard]] Checked<AsymmetricHeader>
read_open_header(const Frame& frame, const Conversation& conversation, const OpenContext& context);

/// Checks an OPN with these headers in the order of Part 6, 6.7.7, then its body (Part 4, 5.6.2).
/// The refusal is exact, for the log; other code decides what the peer may learn of it.
[[nodiscard]] Checked<OpenRequest> read_open_request(const Frame& frame,
                                                     const AsymmetricHeader& header,
                                                     Conversation& conversation,
                                                     const OpenContext& context);

// The same in two parts; open_asymmetric is called between them, even if the first one objects.

[[nodiscard]] Checked<OpenSender> read_open_sender(const AsymmetricHeader& header,
                                                   const Conversation& conversation,
                                                   const OpenContext& context);
[[nodiscard]] Checked<OpenRequest> judge_open_request(Result<AsymmetricContent> opened,
                                                      OpenSender sender,
                                                      const crypto::SecurityPolicy& policy,
                                                      Conversation& conversation,
                                                      const OpenContext& context);

} // namespace busbar::channel::detail
