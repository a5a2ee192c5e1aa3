#include "reconnect.hpp"

#include <algorithm>
#include <array>

namespace busbar::client::detail {

namespace {

struct FinalError {
    StatusCode status;
    std::string_view reason;
};

constexpr std::string_view configuration = "the configuration has to be corrected";
constexpr std::string_view user = "the server does not accept the user";
constexpr std::string_view trust = "the server's certificate has to be trusted or replaced";
constexpr std::string_view offer = "the server offers nothing that may be used";

/// All other failures may end with time: a server that is starting or full, or a broken line. So
/// may Bad_SecurityChecksFailed, which is all that a server says until its administrator trusts the
/// client's certificate (Part 4, 6.1.3). Repeating a wrong password would lock the user out.
constexpr std::array final_errors{
    FinalError{status::Bad_ConfigurationError, configuration},
    FinalError{status::Bad_TcpEndpointUrlInvalid, configuration},
    FinalError{status::Bad_ServerUriInvalid, "another server than the configured one answers"},
    FinalError{status::Bad_CertificateUriInvalid, trust},
    FinalError{status::Bad_CertificateUntrusted, trust},
    FinalError{status::Bad_CertificateTimeInvalid, trust},
    FinalError{status::Bad_CertificateIssuerTimeInvalid, trust},
    FinalError{status::Bad_CertificateHostNameInvalid, trust},
    FinalError{status::Bad_CertificateUseNotAllowed, trust},
    FinalError{status::Bad_CertificateIssuerUseNotAllowed, trust},
    FinalError{status::Bad_CertificateChainIncomplete, trust},
    FinalError{status::Bad_CertificatePolicyCheckFailed, trust},
    FinalError{status::Bad_CertificateRevocationUnknown, trust},
    FinalError{status::Bad_CertificateIssuerRevocationUnknown, trust},
    FinalError{status::Bad_CertificateRevoked, trust},
    FinalError{status::Bad_CertificateIssuerRevoked, trust},
    FinalError{status::Bad_SecurityPolicyRejected, offer},
    FinalError{status::Bad_SecurityModeRejected, offer},
    FinalError{status::Bad_IdentityTokenInvalid, user},
    FinalError{status::Bad_IdentityTokenRejected, user},
    FinalError{status::Bad_UserAccessDenied, user},
    FinalError{status::Bad_UserSignatureInvalid, user},
};

} // namespace

std::string_view final_reason(StatusCode status)
{
    const auto* const found = std::ranges::find(final_errors, status.code(), &FinalError::status);
    return found == final_errors.end() ? std::string_view{} : found->reason;
}

bool is_server_full(StatusCode status)
{
    const StatusCode code = status.code();
    return code == status::Bad_TcpNotEnoughResources || code == status::Bad_TcpServerTooBusy;
}

bool is_session_gone(StatusCode status)
{
    const StatusCode code = status.code();
    return code == status::Bad_SessionIdInvalid || code == status::Bad_SessionClosed ||
           code == status::Bad_SessionNotActivated || code == status::Bad_SecureChannelIdInvalid;
}

BackOff::BackOff(const ReconnectPolicy& policy)
    : first_{std::max<Duration>(policy.first, std::chrono::milliseconds{1})}, longest_{std::max(
                                                                                  policy.longest,
                                                                                  first_)},
      factor_{policy.factor >= 1 ? std::min(policy.factor, 1'000.0) : 1}, next_{first_}
{
}

Duration BackOff::next(crypto::Random& random)
{
    std::array<std::byte, 1> chance{};
    // Without randomness the delay is the full one.
    static_cast<void>(random.fill(chance));
    const double share = 1 - 0.2 * std::to_integer<int>(chance[0]) / 256;
    const auto ticks = static_cast<double>(next_.count());
    const auto wait = Duration{static_cast<Duration::rep>(ticks * share)};
    next_ = ticks * factor_ >= static_cast<double>(longest_.count())
                ? longest_
                : Duration{static_cast<Duration::rep>(ticks * factor_)};
    return wait;
}

} // namespace busbar::client::detail
