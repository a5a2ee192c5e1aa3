#pragma once

#include <string>
#include <vector>

#include <busbar/client/user_identity.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/result.hpp>
#include <busbar/core/types.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/types/discovery.hpp>

namespace busbar::client {

/// The security that a client accepts. The default refuses insecure endpoints.
struct SecurityWishes {
    /// Short names of policies ("Basic256Sha256") or their URIs in order of preference; if empty,
    /// all that are not deprecated, as Part 7 ranks them.
    std::vector<std::string> policies;
    MessageSecurityMode min_mode{MessageSecurityMode::SignAndEncrypt};
    /// Allows None as well, if the server offers nothing better: for a marked demo.
    bool allows_none{false};
};

/// The endpoint to connect to, and how to authenticate there.
struct EndpointChoice {
    EndpointDescription endpoint;
    const crypto::SecurityPolicy* policy{nullptr};
    /// The token policy that the user's identity is sent with.
    UserTokenPolicy token_policy;
    /// The URL that the server was reached by. A client goes on with it if the URL of `endpoint`
    /// does not answer, as behind a port map; empty if there is none.
    std::string reached_by{};
};

/// Chooses the best of `endpoints` that both sides allow, by mode, then policy, then the server's
/// securityLevel (Part 4, 7.14): UA TCP binary, with a token policy for `identity`. Its URL is the
/// one that the server was reached by if the server names another host (Part 4, 5.5.4.1). Devices
/// that leave out the transport, or the policy beside the mode None, are understood.
///
/// Never falls back silently: Bad_SecurityPolicyRejected, Bad_SecurityModeRejected or
/// Bad_IdentityTokenRejected, and the log says what was offered and what the client wanted. Policy
/// None is always logged. Bad_ConfigurationError for a policy that this build does not know,
/// Bad_ResponseTooLarge for more than 500 endpoints.
[[nodiscard]] BUSBAR_API Result<EndpointChoice>
choose_endpoint(const Array<EndpointDescription>& endpoints, const SecurityWishes& wishes,
                const UserIdentity& identity, std::string_view reached_by, LogSink& log);

/// Checks that CreateSession's list is the result of GetEndpoints, in any order, so that a party in
/// between cannot remove the better ones (Part 4, 5.7.2.2). Compares what a client has to compare
/// of the UA TCP endpoints, except the URL. Bad_SecurityChecksFailed.
[[nodiscard]] BUSBAR_API Result<void> check_endpoints(const Array<EndpointDescription>& discovered,
                                                      const Array<EndpointDescription>& of_session);

} // namespace busbar::client
