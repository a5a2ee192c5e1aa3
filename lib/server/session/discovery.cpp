#include "session_services.hpp"

#include <algorithm>

#include <busbar/channel/endpoint_url.hpp>

#include "core/ascii_case.hpp"
#include "server/users/user_policies.hpp"

namespace busbar::server::detail {

namespace {

constexpr std::string_view transport_profile =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";

bool is_own_host(const SessionNeeds& needs, const channel::EndpointUrl& own, std::string_view host)
{
    const auto is_it = [host](const std::string& name) {
        return channel::is_same_host(name, host);
    };
    if (is_it(own.host) ||
        std::any_of(needs.config.host_names.begin(), needs.config.host_names.end(), is_it)) {
        return true;
    }
    if (!needs.config.identity) {
        return false;
    }
    const auto names = needs.config.identity->certificates.front().host_names();
    return std::any_of(names.begin(), names.end(), is_it);
}

/// The ApplicationName exists in one language only, whatever locales are requested.
ApplicationDescription describe_application(const SessionNeeds& needs, const std::string& url)
{
    ApplicationDescription description;
    description.application_uri = needs.config.application_uri;
    description.product_uri = needs.config.product_uri;
    description.application_name = LocalizedText{
        needs.config.locale_ids.empty() ? String{} : String{needs.config.locale_ids.front()},
        String{needs.config.application_name}};
    description.application_type = ApplicationType::Server;
    description.discovery_urls = Array<String>{String{url}};
    return description;
}

/// The larger, the safer (Part 4, 7.14).
std::uint8_t security_level(const EndpointConfig& endpoint)
{
    if (endpoint.security.policy->is_none()) {
        return 0;
    }
    const auto policies = crypto::security_policies();
    const auto rank = endpoint.security.policy - policies.data();
    const bool is_encrypted = endpoint.security.mode == MessageSecurityMode::SignAndEncrypt;
    if (endpoint.security.policy->is_deprecated) {
        return static_cast<std::uint8_t>((is_encrypted ? 10 : 0) + rank); // below all others
    }
    const int mode = is_encrypted ? 100 : 50;
    return static_cast<std::uint8_t>(mode + rank);
}

/// Part 4, 5.5.3.2: compares without case.
bool has_all(const std::vector<std::string>& capabilities, const Array<String>& wanted)
{
    return std::all_of(wanted.begin(), wanted.end(), [&](const String& identifier) {
        return std::any_of(capabilities.begin(), capabilities.end(), [&](const std::string& own) {
            return busbar::detail::is_same_ignoring_case(own, identifier.view());
        });
    });
}

ServerOnNetwork describe_record(const NetworkServer& server, std::size_t record_id)
{
    ServerOnNetwork record;
    record.record_id = static_cast<std::uint32_t>(record_id);
    record.server_name = server.name;
    record.discovery_url = server.discovery_url;
    record.server_capabilities = Array<String>(0);
    for (const std::string& capability : server.capabilities) {
        record.server_capabilities.emplace_back(capability);
    }
    return record;
}

} // namespace

std::string endpoint_url_for(const SessionNeeds& needs, std::string_view requested)
{
    auto own = channel::EndpointUrl::parse(needs.config.endpoint_url);
    if (!own) {
        return needs.config.endpoint_url;
    }
    const auto url = channel::EndpointUrl::parse(requested);
    if (!url) {
        return own->text();
    }
    const auto is_it = [&](const std::string& text) {
        const auto further = channel::EndpointUrl::parse(text);
        return further && further->port == url->port &&
               channel::is_same_host(further->host, url->host);
    };
    const auto& further = needs.config.further_urls;
    if (std::any_of(further.begin(), further.end(), is_it)) {
        own->host = url->host;
        own->port = url->port;
    } else if (is_own_host(needs, *own, url->host)) {
        own->host = url->host;
    }
    return own->text();
}

ByteString server_certificates(const SessionNeeds& needs)
{
    if (!needs.config.identity) {
        return {};
    }
    std::vector<std::byte> all;
    for (const crypto::Certificate& certificate : needs.config.identity->certificates) {
        all.insert(all.end(), certificate.der().begin(), certificate.der().end());
    }
    return ByteString{all};
}

Array<EndpointDescription> describe_endpoints(const SessionNeeds& needs,
                                              std::string_view requested_url)
{
    const std::string url = endpoint_url_for(needs, requested_url);
    Array<EndpointDescription> endpoints;
    endpoints.clear();
    for (const EndpointConfig& config : needs.config.endpoints) {
        EndpointDescription& endpoint = endpoints.emplace_back();
        endpoint.endpoint_url = url;
        endpoint.server = describe_application(needs, url);
        endpoint.server_certificate = server_certificates(needs);
        endpoint.security_mode = config.security.mode;
        endpoint.security_policy_uri = config.security.policy->uri;
        endpoint.user_identity_tokens =
            Array<UserTokenPolicy>{token_policies(needs.config, config, needs.environment.users)};
        endpoint.transport_profile_uri = transport_profile;
        endpoint.security_level = security_level(config);
    }
    return endpoints;
}

StatusCode find_servers(const SessionNeeds& needs, ServiceContext&,
                        const FindServersRequest& request, FindServersResponse& response)
{
    const auto is_own = [&](const String& uri) {
        return uri.view() == needs.config.application_uri;
    };
    response.servers.clear();
    if (request.server_uris.empty() ||
        std::any_of(request.server_uris.begin(), request.server_uris.end(), is_own)) {
        response.servers.push_back(
            describe_application(needs, endpoint_url_for(needs, request.endpoint_url.view())));
    }
    return status::Good;
}

StatusCode find_servers_on_network(const SessionNeeds& needs, ServiceContext&,
                                   const FindServersOnNetworkRequest& request,
                                   FindServersOnNetworkResponse& response)
{
    const std::vector<NetworkServer>& all = needs.config.network_servers;
    if (all.empty()) {
        return status::Bad_ServiceUnsupported;
    }
    // No server has so many; a longer list only causes work.
    constexpr std::size_t max_capabilities = 100;
    if (request.server_capability_filter.size() > max_capabilities) {
        return status::Bad_InvalidArgument;
    }
    const std::size_t most =
        request.max_records_to_return == 0 ? all.size() : request.max_records_to_return;
    response.last_counter_reset_time = needs.start_time;
    response.servers.clear();
    // Records after the given one, of which the first is 1.
    for (std::size_t i = request.starting_record_id;
         i < all.size() && response.servers.size() < most; ++i) {
        if (has_all(all[i].capabilities, request.server_capability_filter)) {
            response.servers.push_back(describe_record(all[i], i + 1));
        }
    }
    return status::Good;
}

StatusCode get_endpoints(const SessionNeeds& needs, ServiceContext&,
                         const GetEndpointsRequest& request, GetEndpointsResponse& response)
{
    const auto is_served = [](const String& uri) { return uri.view() == transport_profile; };
    if (request.profile_uris.empty() ||
        std::any_of(request.profile_uris.begin(), request.profile_uris.end(), is_served)) {
        response.endpoints = describe_endpoints(needs, request.endpoint_url.view());
    } else {
        response.endpoints.clear();
    }
    return status::Good;
}

} // namespace busbar::server::detail
