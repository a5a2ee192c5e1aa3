#include <busbar/harness/discovery_server.hpp>

#include <algorithm>
#include <iterator>
#include <utility>

#include <busbar/crypto/security_policy.hpp>

#include "core/ascii_case.hpp"

namespace busbar::harness {

namespace {

constexpr std::string_view transport_profile =
    "http://opcfoundation.org/UA-Profile/Transport/uatcp-uasc-uabinary";

ScriptedServerParts parts_of(const DiscoveryServerOptions& options)
{
    ScriptedServerParts parts;
    parts.allowed = options.endpoints;
    const channel::SecuritySetting none;
    if (std::find(parts.allowed.begin(), parts.allowed.end(), none) == parts.allowed.end()) {
        parts.allowed.push_back(none);
    }
    parts.validator = options.validator;
    parts.identity = options.identity;
    return parts;
}

/// Returns the name in the first available of the locales, else the first name.
LocalizedText name_for(const RegisteredServer& server, const Array<String>& locale_ids)
{
    for (const String& locale : locale_ids) {
        const auto found =
            std::find_if(server.server_names.begin(), server.server_names.end(),
                         [&](const LocalizedText& name) { return name.locale == locale; });
        if (found != server.server_names.end()) {
            return *found;
        }
    }
    return server.server_names[0];
}

ApplicationDescription describe(const RegisteredServer& server, const Array<String>& locale_ids)
{
    ApplicationDescription description;
    description.application_uri = server.server_uri;
    description.product_uri = server.product_uri;
    description.application_name = name_for(server, locale_ids);
    description.application_type = server.server_type;
    description.gateway_server_uri = server.gateway_server_uri;
    description.discovery_urls = server.discovery_urls;
    return description;
}

bool is_empty(const String& text)
{
    return text.empty();
}

} // namespace

DiscoveryServer::DiscoveryServer(World& world, DiscoveryServerOptions options)
    : world_{world}, options_{std::move(options)}, server_{world, options_.url, parts_of(options_)}
{
    server_.forgive_report(); // of what it does not know, it answers Bad_ServiceUnsupported
    answer_requests();
}

void DiscoveryServer::answer_requests()
{
    server_.allow<FindServersRequest>().reply(
        [this](const FindServersRequest& request) { return find_servers(request); });
    server_.allow<FindServersOnNetworkRequest>().reply(
        [this](const FindServersOnNetworkRequest& request) { return find_on_network(request); });
    server_.allow<GetEndpointsRequest>().reply(
        [this](const GetEndpointsRequest&) { return get_endpoints(); });
    server_.allow<RegisterServerRequest>().reply(
        [this](const RegisterServerRequest& request) -> Result<RegisterServerResponse> {
            if (auto registered = register_server({request.server}); !registered) {
                return fail(registered.error());
            }
            return RegisterServerResponse{};
        });
    if (options_.knows_register_server_2) {
        server_.allow<RegisterServer2Request>().reply(
            [this](const RegisterServer2Request& request) { return register_extended(request); });
    }
}

const std::map<std::string, DiscoveryServer::Entry, std::less<>>& DiscoveryServer::entries()
{
    forget_expired();
    return entries_;
}

const DiscoveryServer::Entry* DiscoveryServer::find(std::string_view server_uri)
{
    forget_expired();
    const auto found = entries_.find(server_uri);
    return found == entries_.end() ? nullptr : &found->second;
}

std::size_t DiscoveryServer::count(std::string_view request) const
{
    return static_cast<std::size_t>(std::count(came().begin(), came().end(), request));
}

/// Part 4, 7.32: an entry with a semaphore file lasts as long as the file.
void DiscoveryServer::forget_expired()
{
    for (auto entry = entries_.begin(); entry != entries_.end();) {
        const std::string_view file = entry->second.server.semaphore_file_path.view();
        const bool is_over = file.empty() ? entry->second.expires_at <= world_.now()
                                          : files_.find(file) == files_.end();
        entry = is_over ? entries_.erase(entry) : std::next(entry);
    }
}

ApplicationDescription DiscoveryServer::describe_itself() const
{
    ApplicationDescription description;
    description.application_uri = options_.application_uri;
    description.application_name = LocalizedText{String{"en"}, String{"Discovery server"}};
    description.application_type = ApplicationType::DiscoveryServer;
    description.discovery_urls.push_back(String{options_.url});
    return description;
}

FindServersResponse DiscoveryServer::find_servers(const FindServersRequest& request)
{
    const auto is_wanted = [&](const String& uri) {
        return request.server_uris.empty() ||
               std::find(request.server_uris.begin(), request.server_uris.end(), uri) !=
                   request.server_uris.end();
    };
    FindServersResponse response;
    response.servers.clear();
    if (auto own = describe_itself(); is_wanted(own.application_uri)) {
        response.servers.push_back(std::move(own));
    }
    for (const auto& [uri, entry] : entries()) {
        if (is_wanted(entry.server.server_uri)) {
            response.servers.push_back(describe(entry.server, request.locale_ids));
        }
    }
    return response;
}

/// Part 4, 5.5.3: in the order of their records.
FindServersOnNetworkResponse
DiscoveryServer::find_on_network(const FindServersOnNetworkRequest& request)
{
    const auto has = [](const Entry& entry, const String& wanted) {
        return std::ranges::any_of(entry.capabilities, [&](const std::string& own) {
            return busbar::detail::is_same_ignoring_case(own, wanted.view());
        });
    };
    FindServersOnNetworkResponse response;
    response.servers.clear();
    for (const auto& each : entries()) {
        const Entry& entry = each.second;
        if (entry.record_id > request.starting_record_id &&
            std::ranges::all_of(request.server_capability_filter,
                                [&](const String& wanted) { return has(entry, wanted); })) {
            ServerOnNetwork& record = response.servers.emplace_back();
            record.record_id = entry.record_id;
            record.server_name = entry.mdns_name;
            record.discovery_url = entry.server.discovery_urls[0];
            for (const std::string& capability : entry.capabilities) {
                record.server_capabilities.emplace_back(capability);
            }
        }
    }
    std::ranges::sort(response.servers, {}, &ServerOnNetwork::record_id);
    if (request.max_records_to_return != 0 &&
        response.servers.size() > request.max_records_to_return) {
        response.servers.resize(request.max_records_to_return);
    }
    return response;
}

/// Without token policies: there are no sessions (Part 12, 5.1).
GetEndpointsResponse DiscoveryServer::get_endpoints() const
{
    GetEndpointsResponse response;
    response.endpoints.clear();
    std::uint8_t level = 0;
    for (const channel::SecuritySetting& security : options_.endpoints) {
        EndpointDescription& endpoint = response.endpoints.emplace_back();
        endpoint.endpoint_url = options_.url;
        endpoint.server = describe_itself();
        endpoint.security_mode = security.mode;
        endpoint.security_policy_uri = security.policy->uri;
        endpoint.transport_profile_uri = transport_profile;
        endpoint.security_level = security.policy->is_none() ? std::uint8_t{0} : ++level;
        if (options_.identity != nullptr) {
            endpoint.server_certificate = ByteString{options_.identity->certificates.front().der()};
        }
    }
    return response;
}

Result<RegisterServer2Response>
DiscoveryServer::register_extended(const RegisterServer2Request& request)
{
    if (request.discovery_configuration.size() > options_.limits.max_entries) {
        return fail(status::Bad_InvalidArgument);
    }
    RegisterServer2Response response;
    Entry entry{request.server};
    for (const ExtensionObject& configuration : request.discovery_configuration) {
        const auto* const mdns = configuration.get_if<MdnsDiscoveryConfiguration>();
        // Part 4, 5.5.6.2.
        response.configuration_results.push_back(
            mdns != nullptr ? StatusCode{} : StatusCode{status::Bad_NotSupported});
        if (mdns != nullptr) {
            if (mdns->server_capabilities.size() > options_.limits.max_entries) {
                return fail(status::Bad_InvalidArgument);
            }
            for (const String& capability : mdns->server_capabilities) {
                entry.capabilities.push_back(capability.str());
            }
            entry.mdns_name = mdns->mdns_server_name.str();
            const Entry* const known = find(request.server.server_uri.view());
            const bool has_record = known != nullptr && known->record_id != 0;
            entry.record_id = has_record ? known->record_id : ++last_record_;
        }
    }
    if (auto registered = register_server(std::move(entry)); !registered) {
        return fail(registered.error());
    }
    return response;
}

Result<void> DiscoveryServer::register_server(Entry entry)
{
    const RegisteredServer& server = entry.server;
    forget_expired();
    for (const StatusCode checked : {check_caller(server), check_texts(server)}) {
        if (checked.is_bad()) {
            return fail(checked);
        }
    }
    const std::string uri = server.server_uri.str();
    const std::string_view file = server.semaphore_file_path.view();
    if (!file.empty() && files_.find(file) == files_.end()) {
        entries_.erase(uri);
        return fail(status::Bad_SemaphoreFileMissing);
    }
    // The semaphore file has precedence over isOnline (Part 4, 7.32).
    if (file.empty() && !server.is_online) {
        entries_.erase(uri);
        return {};
    }
    if (entries_.find(uri) == entries_.end() && entries_.size() >= options_.limits.max_servers) {
        return fail(status::Bad_ResourceUnavailable);
    }
    entry.expires_at = world_.now() + options_.lifetime;
    entries_.insert_or_assign(uri, std::move(entry));
    return {};
}

/// Part 4, 5.5.5.1: a client that registers must prove that it is that server.
StatusCode DiscoveryServer::check_caller(const RegisteredServer& server) const
{
    const channel::ServerChannel& channel = server_.channel();
    if (channel.security().policy->is_none()) {
        return options_.allows_unsecured ? StatusCode{}
                                         : StatusCode{status::Bad_SecurityModeInsufficient};
    }
    return channel.peer_certificates().front().is_of_application(server.server_uri.view())
               ? StatusCode{}
               : StatusCode{status::Bad_ServerUriInvalid};
}

/// Part 4, 5.5.5.3.
StatusCode DiscoveryServer::check_texts(const RegisteredServer& server) const
{
    const DiscoveryServerLimits& limits = options_.limits;
    const auto is_long = [&](const String& text) { return text.size() > limits.max_text; };
    const auto& names = server.server_names;
    const auto& urls = server.discovery_urls;
    if (server.server_uri.empty()) {
        return status::Bad_ServerUriInvalid;
    }
    if (std::ranges::all_of(names, is_empty, &LocalizedText::text)) {
        return status::Bad_ServerNameMissing;
    }
    if (std::ranges::all_of(urls, is_empty)) {
        return status::Bad_DiscoveryUrlMissing;
    }
    const bool is_too_much = names.size() > limits.max_entries ||
                             urls.size() > limits.max_entries || is_long(server.server_uri) ||
                             is_long(server.product_uri) || is_long(server.gateway_server_uri) ||
                             is_long(server.semaphore_file_path) ||
                             std::ranges::any_of(names, is_long, &LocalizedText::text) ||
                             std::ranges::any_of(urls, is_long);
    return server.server_type == ApplicationType::Client || is_too_much
               ? StatusCode{status::Bad_InvalidArgument}
               : StatusCode{};
}

} // namespace busbar::harness
