#include <busbar/client/endpoint_choice.hpp>

#include <algorithm>
#include <tuple>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/core/text.hpp>

#include "endpoint_filter.hpp"
#include "user_token.hpp"

namespace busbar::client {

namespace {

constexpr std::string_view transport_profile =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";
/// Its URI in version 1.00, which old devices still send.
constexpr std::string_view first_transport_profile =
    "http://opcfoundation.org/UA/profiles/transport/uatcp";
/// A server has a few for each of its addresses; checking each certificate takes time.
constexpr std::size_t max_endpoints = 500;
/// Maximum number of a server's endpoints in a log line.
constexpr std::size_t max_logged_endpoints = 20;

/// Says how far an endpoint gets in the selection; the farthest one determines the error.
enum class Step : std::uint8_t { Transport, Policy, Mode, Token, Fit };

struct Candidate {
    const EndpointDescription* endpoint;
    const crypto::SecurityPolicy* policy;
    const UserTokenPolicy* token_policy;
    std::size_t policy_rank;

    /// Ranks by mode, then policy, then the server's securityLevel (Part 4, 7.14).
    [[nodiscard]] auto rank() const
    {
        return std::tuple{endpoint->security_mode, policy_rank, endpoint->security_level};
    }
};

bool is_named(const crypto::SecurityPolicy& policy, std::string_view wish)
{
    return wish == policy.name || wish == policy.uri;
}

/// Returns 1 for the lowest preference and more for higher ones; 0 if it is not accepted.
std::size_t rank(const crypto::SecurityPolicy& policy, const SecurityWishes& wishes)
{
    if (policy.is_none()) {
        return wishes.allows_none ? 1 : 0;
    }
    if (wishes.policies.empty()) {
        // Part 7 ranks the policies, and the table is in its order.
        const auto all = crypto::security_policies();
        return policy.is_deprecated ? 0 : static_cast<std::size_t>(&policy - all.data()) + 1;
    }
    const auto found = std::ranges::find_if(
        wishes.policies, [&](const std::string& wish) { return is_named(policy, wish); });
    return static_cast<std::size_t>(wishes.policies.end() - found);
}

/// There are devices that leave the URI out or end it with a slash: then the scheme of the URL,
/// which is that of UA TCP or missing too, says which transport it is.
bool is_transport(const EndpointDescription& endpoint)
{
    std::string_view uri = endpoint.transport_profile_uri.view();
    if (uri.empty()) {
        const std::string_view url = endpoint.endpoint_url.view();
        return url.empty() || channel::EndpointUrl::parse(url).has_value();
    }
    uri.remove_suffix(uri.ends_with('/') ? 1 : 0);
    return uri == transport_profile || uri == first_transport_profile;
}

/// A URI that is missing means None beside the mode None, and nothing beside the others.
const crypto::SecurityPolicy* policy_of(const EndpointDescription& endpoint)
{
    const bool is_none =
        endpoint.security_policy_uri.empty() && endpoint.security_mode == MessageSecurityMode::None;
    return is_none ? crypto::find_policy_by_name("None")
                   : crypto::find_policy(endpoint.security_policy_uri.view());
}

/// True if policy and mode fit together, with a certificate if it needs one.
bool is_consistent(const EndpointDescription& endpoint, const crypto::SecurityPolicy& policy)
{
    if (policy.is_none()) {
        return endpoint.security_mode == MessageSecurityMode::None;
    }
    return (endpoint.security_mode == MessageSecurityMode::Sign ||
            endpoint.security_mode == MessageSecurityMode::SignAndEncrypt) &&
           crypto::parse_chain(endpoint.server_certificate.span()).has_value();
}

/// Fills in `candidate` as far as the endpoint fits.
Step judge(const EndpointDescription& endpoint, const SecurityWishes& wishes,
           const UserIdentity* identity, Candidate& candidate)
{
    if (!is_transport(endpoint)) {
        return Step::Transport;
    }
    const auto* policy = policy_of(endpoint);
    candidate = {&endpoint, policy, nullptr, policy != nullptr ? rank(*policy, wishes) : 0};
    if (candidate.policy_rank == 0 || !is_consistent(endpoint, *policy)) {
        return Step::Policy;
    }
    if (!policy->is_none() && endpoint.security_mode < wishes.min_mode) {
        return Step::Mode;
    }
    if (identity != nullptr) {
        candidate.token_policy = detail::find_token_policy(
            endpoint.user_identity_tokens, {policy, endpoint.security_mode}, *identity);
        return candidate.token_policy != nullptr ? Step::Fit : Step::Token;
    }
    return Step::Fit;
}

std::string_view name_of(MessageSecurityMode mode)
{
    const std::string_view name = channel::name(mode);
    return mode == MessageSecurityMode::Invalid || name.empty() ? "no mode" : name;
}

std::string_view name_of(UserTokenType type)
{
    switch (type) {
    case UserTokenType::Anonymous:
        return "anonymous";
    case UserTokenType::UserName:
        return "user name";
    case UserTokenType::Certificate:
        return "certificate";
    case UserTokenType::IssuedToken:
        return "issued token";
    }
    return "unknown token";
}

std::string describe(const EndpointDescription& endpoint)
{
    const auto* policy = policy_of(endpoint);
    std::string text = policy != nullptr ? std::string{policy->name}
                                         : printable(endpoint.security_policy_uri.view(), 80);
    text += "/" + std::string{name_of(endpoint.security_mode)} + " (";
    const std::size_t count = std::min<std::size_t>(endpoint.user_identity_tokens.size(), 8);
    for (std::size_t i = 0; i < count; ++i) {
        text += (i == 0 ? "" : ", ") +
                std::string{name_of(endpoint.user_identity_tokens[i].token_type)};
    }
    return text + (is_transport(endpoint) ? ")" : "), not UA TCP");
}

std::string describe_offer(const Array<EndpointDescription>& endpoints)
{
    std::string text;
    for (std::size_t i = 0; i < std::min(endpoints.size(), max_logged_endpoints); ++i) {
        text += (text.empty() ? "" : "; ") + describe(endpoints[i]);
    }
    if (endpoints.size() > max_logged_endpoints) {
        text += "; and " + std::to_string(endpoints.size() - max_logged_endpoints) + " more";
    }
    return text.empty() ? "nothing" : text;
}

std::string describe_wishes(const SecurityWishes& wishes, const UserIdentity* identity)
{
    std::string text;
    for (const std::string& policy : wishes.policies) {
        text += (text.empty() ? "" : ", ") + policy;
    }
    text = (text.empty() ? "any policy that is not deprecated" : text) + " with at least " +
           std::string{name_of(wishes.min_mode)};
    text += wishes.allows_none ? ", or None" : "";
    return identity == nullptr ? text
                               : text + ", for " + std::string{name_of(detail::type_of(*identity))};
}

StatusCode status_of(Step farthest)
{
    switch (farthest) {
    case Step::Mode:
        return status::Bad_SecurityModeRejected;
    case Step::Token:
        return status::Bad_IdentityTokenRejected;
    default:
        return status::Bad_SecurityPolicyRejected;
    }
}

/// A wish that no endpoint can fulfil is a configuration error.
Result<void> check_wishes(const SecurityWishes& wishes, LogSink& log)
{
    for (const std::string& wish : wishes.policies) {
        if (crypto::find_policy(wish) == nullptr && crypto::find_policy_by_name(wish) == nullptr) {
            explain(log, "client",
                    {status::Bad_ConfigurationError, "security policies that are wanted",
                     "this build knows no " + printable(wish), "Part 7, 6.6",
                     "Correct its name; deprecated policies are an option of the build"});
            return fail(status::Bad_ConfigurationError);
        }
    }
    return {};
}

/// Returns the URL by which a client has reached the server; the server's own name may be of
/// another network (Part 4, 5.5.4.1). It also keeps servers from redirecting clients to any host
/// they like.
std::string url_for(const EndpointDescription& endpoint, std::string_view reached_by)
{
    const auto own = channel::EndpointUrl::parse(endpoint.endpoint_url.view());
    const auto reached = channel::EndpointUrl::parse(reached_by);
    return own && (!reached || channel::is_same_host(own->host, reached->host))
               ? own->text()
               : std::string{reached_by};
}

/// Returns the parts of an endpoint that a client compares (Part 4, 5.7.2.2), as text. The URL is
/// not among them, since a server repeats the client's.
std::string key_of(const EndpointDescription& endpoint)
{
    std::string key;
    const auto add = [&](std::string_view part) {
        key += std::to_string(part.size()) + ":" + std::string{part};
    };
    add(endpoint.server.application_uri.view());
    add(endpoint.security_policy_uri.view());
    add(std::to_string(static_cast<std::int32_t>(endpoint.security_mode)));
    add(std::to_string(endpoint.security_level));
    for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
        add(policy.policy_id.view());
        add(std::to_string(static_cast<std::int32_t>(policy.token_type)));
        add(policy.issued_token_type.view());
        add(policy.security_policy_uri.view());
    }
    return key;
}

std::vector<std::string> keys_of(const Array<EndpointDescription>& endpoints)
{
    std::vector<std::string> keys;
    for (const EndpointDescription& endpoint : endpoints) {
        if (is_transport(endpoint)) {
            keys.push_back(key_of(endpoint));
        }
    }
    std::ranges::sort(keys);
    return keys;
}

} // namespace

namespace detail {

Result<EndpointChoice> choose_endpoint(const Array<EndpointDescription>& endpoints,
                                       const SecurityWishes& wishes, const UserIdentity* identity,
                                       std::string_view reached_by, LogSink& log)
{
    if (auto checked = check_wishes(wishes, log); !checked) {
        return fail(checked.error());
    }
    if (endpoints.size() > max_endpoints) {
        return fail(status::Bad_ResponseTooLarge);
    }
    Step farthest = Step::Transport;
    std::optional<Candidate> best;
    for (const EndpointDescription& endpoint : endpoints) {
        Candidate candidate{};
        const Step step = judge(endpoint, wishes, identity, candidate);
        farthest = std::max(farthest, step);
        if (step == Step::Fit && (!best || candidate.rank() > best->rank())) {
            best = candidate;
        }
    }
    if (!best) {
        const StatusCode status = status_of(farthest);
        explain(log, "client",
                {status, "choice of an endpoint",
                 "the server offers " + describe_offer(endpoints) + "; the client wants " +
                     describe_wishes(wishes, identity),
                 "Part 4, 5.5.4", "Change what one of the two is configured for"});
        return fail(status);
    }
    if (best->policy->is_none()) {
        log.write(LogLevel::Warning, "client",
                  "INSECURE: connecting without security; the server offers " +
                      describe_offer(endpoints));
    }
    EndpointChoice choice{*best->endpoint, best->policy, {}, std::string{reached_by}};
    choice.endpoint.endpoint_url = String{url_for(*best->endpoint, reached_by)};
    if (best->token_policy != nullptr) {
        choice.token_policy = *best->token_policy;
    }
    return choice;
}

} // namespace detail

Result<EndpointChoice> choose_endpoint(const Array<EndpointDescription>& endpoints,
                                       const SecurityWishes& wishes, const UserIdentity& identity,
                                       std::string_view reached_by, LogSink& log)
{
    return detail::choose_endpoint(endpoints, wishes, &identity, reached_by, log);
}

Result<void> check_endpoints(const Array<EndpointDescription>& discovered,
                             const Array<EndpointDescription>& of_session)
{
    if (keys_of(discovered) != keys_of(of_session)) {
        return fail(status::Bad_SecurityChecksFailed);
    }
    return {};
}

} // namespace busbar::client
