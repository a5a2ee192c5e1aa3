#pragma once

#include <busbar/client/connection.hpp>
#include <busbar/types/session.hpp>

namespace busbar::client::detail {

/// What CreateSession gave and ActivateSession needs.
struct SessionData {
    NodeId authentication_token;
    std::vector<std::byte> client_nonce;
    ByteString client_certificate;
    ByteString server_nonce;
    Array<EndpointDescription> endpoints;
};

[[nodiscard]] Result<CreateSessionRequest> make_create_session(const ConnectionConfig& config,
                                                               const channel::ChannelEnvironment& e,
                                                               SessionData& session);
/// Takes the response in, after its signature was checked (Part 4, 5.7.2).
[[nodiscard]] Result<void> accept_session(const ConnectionConfig& config,
                                          const CreateSessionResponse& response,
                                          SessionData& session);
/// Signature and user token (Part 4, 5.7.3). Bad_IdentityTokenRejected if the server takes no token
/// of the kind that is wanted.
[[nodiscard]] Result<ActivateSessionRequest>
make_activate_session(const ConnectionConfig& config, const channel::ChannelEnvironment& environment,
                      const SessionData& session);

} // namespace busbar::client::detail
