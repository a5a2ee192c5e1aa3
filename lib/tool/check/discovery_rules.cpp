#include <set>

#include <busbar/types/discovery.hpp>

#include "requests.hpp"

namespace busbar::tool::rules {

namespace {
namespace discovery {

constexpr std::string_view ua_tcp =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";

/// Judges the response to a request without a session.
template <typename Response, typename Request, typename Judge>
Answer asked(Subject& subject, Request request, Judge judge)
{
    Line line = subject.open_channel();
    const auto response = line.ask<Response>(std::move(request));
    line.close();
    return with(response, judge);
}

GetEndpointsRequest endpoints_at(std::string url, Array<String> profiles = {})
{
    GetEndpointsRequest request;
    request.endpoint_url = String{url};
    request.profile_uris = std::move(profiles);
    return request;
}

template <typename Judge>
Answer endpoints(Subject& subject, Judge judge)
{
    return asked<GetEndpointsResponse>(
        subject, endpoints_at(subject.config().channel.endpoint_url),
        [&](const GetEndpointsResponse& response) { return judge(response.endpoints); });
}

/// Right if every endpoint is what `is_right` says.
template <typename Judge>
Answer each_endpoint(Subject& subject, Judge is_right)
{
    return endpoints(subject, [&](const Array<EndpointDescription>& all) {
        for (const EndpointDescription& each : all) {
            if (!is_right(each)) {
                return wrong(each.security_policy_uri.str() + " at " + each.endpoint_url.str());
            }
        }
        return expect(!all.empty(), "no endpoint");
    });
}

bool is_none(const EndpointDescription& endpoint)
{
    return endpoint.security_policy_uri.view() == crypto::policy_none().uri;
}

bool has_own_uri(const EndpointDescription& endpoint)
{
    const auto chain = crypto::parse_chain(endpoint.server_certificate.span());
    return !chain || chain->front().application_uri() == endpoint.server.application_uri.view();
}

/// Part 4, 7.41: one of them may be null or empty.
bool has_token_ids(const EndpointDescription& endpoint)
{
    std::set<std::string_view> ids;
    for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
        if (!ids.insert(policy.policy_id.view()).second) {
            return false;
        }
    }
    return !ids.empty();
}

std::string count_of(std::size_t count, std::string_view what)
{
    return std::to_string(count) + " " + std::string{what};
}

template <typename Judge>
Answer servers(Subject& subject, Array<String> uris, Judge judge)
{
    FindServersRequest request;
    request.endpoint_url = subject.config().channel.endpoint_url;
    request.server_uris = std::move(uris);
    return asked<FindServersResponse>(
        subject, std::move(request),
        [&](const FindServersResponse& response) { return judge(response.servers); });
}

/// Right if the server tells of itself, and of what `is_right` says.
template <typename Judge>
Answer own_entry(Subject& subject, Array<String> uris, Judge is_right)
{
    const std::string_view uri = subject.endpoint().server.application_uri.view();
    return servers(subject, std::move(uris), [&](const Array<ApplicationDescription>& all) {
        for (const ApplicationDescription& each : all) {
            if (each.application_uri.view() == uri) {
                return expect(is_right(each), "not so in its own entry");
            }
        }
        return wrong(count_of(all.size(), "servers, itself not among them"));
    });
}

constexpr const char* describing = "Part 4, 7.14";
constexpr const char* getting = "Part 4, 5.5.4.2";
constexpr const char* finding = "Part 4, 5.5.2.2";

const SpecRule rules[] = {
    {"endpoints", "GetEndpoints", "Endpoints need no session", "a request without a session",
     "endpoints", "Part 4, 5.5.1",
     [](Subject& subject) {
         return each_endpoint(subject, [](const EndpointDescription&) { return true; });
     },
     RuleNeed::OpenChannel},
    {"endpoints-url-unknown", "GetEndpoints", "A URL that is not known has endpoints",
     "endpointUrl = opc.tcp://no.such.host:4840", "endpoints", getting,
     [](Subject& subject) {
         return asked<GetEndpointsResponse>(subject, endpoints_at("opc.tcp://no.such.host:4840"),
                                            [](const GetEndpointsResponse& response) {
                                                return expect(!response.endpoints.empty(),
                                                              "no endpoint");
                                            });
     },
     RuleNeed::OpenChannel},
    {"endpoints-profile", "GetEndpoints", "Endpoints are filtered by their transport",
     "profileUris = [UA TCP]", "endpoints of UA TCP", getting,
     [](Subject& subject) {
         return asked<GetEndpointsResponse>(
             subject, endpoints_at(subject.config().channel.endpoint_url, {String{ua_tcp}}),
             [](const GetEndpointsResponse& response) {
                 for (const EndpointDescription& each : response.endpoints) {
                     if (each.transport_profile_uri.view() != ua_tcp) {
                         return wrong(each.transport_profile_uri.str());
                     }
                 }
                 return expect(!response.endpoints.empty(), "no endpoint");
             });
     },
     RuleNeed::OpenChannel},
    {"endpoints-profile-unknown", "GetEndpoints", "A transport that is not there has no endpoints",
     "profileUris = [urn:none.such]", "no endpoint", getting,
     [](Subject& subject) {
         return asked<GetEndpointsResponse>(
             subject,
             endpoints_at(subject.config().channel.endpoint_url, {String{"urn:none.such"}}),
             [](const GetEndpointsResponse& response) {
                 return expect(response.endpoints.empty(),
                               count_of(response.endpoints.size(), "endpoints"));
             });
     },
     RuleNeed::OpenChannel},
    {"endpoints-mode", "GetEndpoints", "Mode None and policy None belong together", "any",
     "both, or neither", describing,
     [](Subject& subject) {
         return each_endpoint(subject, [](const EndpointDescription& each) {
             return (each.security_mode == MessageSecurityMode::None) == is_none(each);
         });
     },
     RuleNeed::OpenChannel},
    {"endpoints-certificate", "GetEndpoints", "An endpoint with security has a certificate", "any",
     "a certificate", "Part 4, 5.5.4.1",
     [](Subject& subject) {
         return each_endpoint(subject, [](const EndpointDescription& each) {
             return is_none(each) ||
                    crypto::parse_chain(each.server_certificate.span()).has_value();
         });
     },
     RuleNeed::OpenChannel},
    {"endpoints-application-uri", "GetEndpoints", "The certificate has the ApplicationUri", "any",
     "the same URI in both", "Part 6, 6.2.2",
     [](Subject& subject) { return each_endpoint(subject, has_own_uri); }, RuleNeed::OpenChannel},
    {"endpoints-token-ids", "GetEndpoints", "Token policies have ids of their own", "any",
     "different policyIds", "Part 4, 7.41",
     [](Subject& subject) { return each_endpoint(subject, has_token_ids); }, RuleNeed::OpenChannel},
    {"servers-itself", "FindServers", "A server finds itself", "a request without a session",
     "its ApplicationUri", "Part 4, 5.5.2.1",
     [](Subject& subject) {
         return own_entry(subject, {}, [](const ApplicationDescription&) { return true; });
     },
     RuleNeed::OpenChannel},
    {"servers-filter", "FindServers", "A server is found by its URI", "serverUris = [its own]",
     "its ApplicationUri", finding,
     [](Subject& subject) {
         return own_entry(subject, {subject.endpoint().server.application_uri},
                          [](const ApplicationDescription&) { return true; });
     },
     RuleNeed::OpenChannel},
    {"servers-filter-unknown", "FindServers", "A URI that is not there finds no server",
     "serverUris = [urn:none.such]", "no server", finding,
     [](Subject& subject) {
         return servers(subject, {String{"urn:none.such"}},
                        [](const Array<ApplicationDescription>& all) {
                            return expect(all.empty(), count_of(all.size(), "servers"));
                        });
     },
     RuleNeed::OpenChannel},
    {"servers-discovery-url", "FindServers", "A server has a URL for discovery", "any",
     "discoveryUrls", "Part 12, 4.3.2",
     [](Subject& subject) {
         return own_entry(subject, {}, [](const ApplicationDescription& each) {
             return !each.discovery_urls.empty();
         });
     },
     RuleNeed::OpenChannel},
    {"servers-type", "FindServers", "A server is not a client", "any",
     "applicationType Server, ClientAndServer or DiscoveryServer", "Part 4, 7.4",
     [](Subject& subject) {
         return own_entry(subject, {}, [](const ApplicationDescription& each) {
             return each.application_type != ApplicationType::Client;
         });
     },
     RuleNeed::OpenChannel},
};

} // namespace discovery
} // namespace

std::span<const SpecRule> discovery_rules()
{
    return discovery::rules;
}

} // namespace busbar::tool::rules
