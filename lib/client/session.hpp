#pragma once

#include <busbar/client/connection.hpp>
#include <busbar/types/session.hpp>

namespace busbar::client::detail {

/// The result of CreateSession, which ActivateSession needs.
struct SessionData {
    SessionTicket ticket;
    std::vector<std::byte> client_nonce;
    ByteString client_certificate;
    Array<EndpointDescription> endpoints;
};

[[nodiscard]] Result<CreateSessionRequest> make_create_session(const ConnectionConfig& config,
                                                               const channel::ChannelEnvironment& e,
                                                               SessionData& session);
/// Stores and checks the response: the server's certificate and signature, its nonce, and that its
/// endpoints are those of GetEndpoints (Part 4, 5.7.2). After a failure the session can only be
/// closed.
[[nodiscard]] Result<void> accept_session(const ConnectionConfig& config,
                                          const channel::ChannelEnvironment& environment,
                                          const CreateSessionResponse& response,
                                          SessionData& session);
/// Creates signature and user token (Part 4, 5.7.3). Bad_IdentityTokenRejected if the server
/// accepts no token of this kind.
[[nodiscard]] Result<ActivateSessionRequest>
make_activate_session(const ConnectionConfig& config,
                      const channel::ChannelEnvironment& environment, const SessionData& session);
/// Stores the next nonce. Bad_NonceInvalid if it is too short or equals the last one.
[[nodiscard]] Result<void> accept_activation(const ConnectionConfig& config,
                                             const ActivateSessionResponse& response,
                                             SessionData& session);

} // namespace busbar::client::detail
