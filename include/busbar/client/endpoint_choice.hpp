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

/// What security a client accepts. The default refuses what is insecure.
struct SecurityWishes {
    /// Short names of policies ("Basic256Sha256") or their URIs, the best first; empty: all that
    /// are not deprecated, as Part 7 ranks them.
    std::vector<std::string> policies;
    MessageSecurityMode min_mode{MessageSecurityMode::SignAndEncrypt};
    /// Also None, if the server offers nothing better: for a marked demo.
    bool allows_none{false};
};

struct EndpointChoice {
    EndpointDescription endpoint;
    const crypto::SecurityPolicy* policy{nullptr};
    /// The token policy that the user's identity is sent with.
    UserTokenPolicy token_policy;
};

/// The best of `endpoints` that both sides allow, by mode, then policy, then the server's
/// securityLevel (Part 4, 7.14): UA TCP binary, with a token policy for `identity`. Its URL is the
/// one that the server was reached by where the server names itself differently (Part 4, 5.5.4.1).
///
/// Never falls back silently: Bad_SecurityPolicyRejected, Bad_SecurityModeRejected or
/// Bad_IdentityTokenRejected, and the log says what was offered and what was wanted. Of policy None
/// the log tells in any case.
/// Bad_ConfigurationError for a wish that this build knows nothing of, Bad_ResponseTooLarge for
/// more endpoints than 500.
[[nodiscard]] BUSBAR_API Result<EndpointChoice>
choose_endpoint(const Array<EndpointDescription>& endpoints, const SecurityWishes& wishes,
                const UserIdentity& identity, std::string_view reached_by, LogSink& log);

/// That CreateSession's list is what GetEndpoints gave, in any order, so that nobody on the way
/// took the better ones away (Part 4, 5.7.2.2). Compared is what a client has to compare of the UA
/// TCP endpoints, but for the URL. Bad_SecurityChecksFailed.
[[nodiscard]] BUSBAR_API Result<void> check_endpoints(const Array<EndpointDescription>& discovered,
                                                      const Array<EndpointDescription>& of_session);

} // namespace busbar::client
