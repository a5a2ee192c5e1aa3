#pragma once

#include <busbar/client/connection.hpp>
#include <busbar/types/session.hpp>

namespace busbar::client::detail {

/// What CreateSession gave and ActivateSession needs.
struct SessionData {
    SessionTicket ticket;
    std::vector<std::byte> client_nonce;
    ByteString client_certificate;
    Array<EndpointDescription> endpoints;
};

[[nodiscard]] Result<CreateSessionRequest> make_create_session(const ConnectionConfig& config,
                                                               const channel::ChannelEnvironment& e,
                                                               SessionData& session);
/// Takes the response in, and checks it: the server's certificate and signature, its nonce, and
/// that its endpoints are those of GetEndpoints (Part 4, 5.7.2). After a failure the session is
/// good for nothing but CloseSession.
[[nodiscard]] Result<void> accept_session(const ConnectionConfig& config,
                                          const channel::ChannelEnvironment& environment,
                                          const CreateSessionResponse& response,
                                          SessionData& session);
/// Signature and user token (Part 4, 5.7.3). Bad_IdentityTokenRejected if the server takes no token
/// of the kind that is wanted.
[[nodiscard]] Result<ActivateSessionRequest>
make_activate_session(const ConnectionConfig& config,
                      const channel::ChannelEnvironment& environment, const SessionData& session);
/// Takes the next nonce in. Bad_NonceInvalid if it is short or the last one.
[[nodiscard]] Result<void> accept_activation(const ConnectionConfig& config,
                                             const ActivateSessionResponse& response,
                                             SessionData& session);

} // namespace busbar::client::detail
