#include "proxy_endpoints.hpp"

#include <algorithm>
#include <utility>

namespace busbar::harness::detail {

namespace {

ByteString chain_of(const channel::ApplicationIdentity* identity)
{
    std::vector<std::byte> chain;
    if (identity != nullptr) {
        for (const crypto::Certificate& certificate : identity->certificates) {
            chain.insert(chain.end(), certificate.der().begin(), certificate.der().end());
        }
    }
    return ByteString{chain};
}

/// Returns the setting of an endpoint; nothing if this build does not know its policy.
std::optional<channel::SecuritySetting> setting_of(const EndpointDescription& endpoint)
{
    const auto* const policy = crypto::find_policy(endpoint.security_policy_uri.view());
    const MessageSecurityMode mode = endpoint.security_mode;
    const bool is_none = mode == MessageSecurityMode::None;
    if (policy == nullptr || policy->is_none() != is_none || mode == MessageSecurityMode::Invalid) {
        return std::nullopt;
    }
    return channel::SecuritySetting{policy, mode};
}

bool is_for(const EndpointDescription& endpoint, const channel::SecuritySetting& security)
{
    return setting_of(endpoint) == security;
}

} // namespace

ProxyEndpoints::ProxyEndpoints(Config config)
    : config_{std::move(config)}, own_chain_{chain_of(config_.identity)}
{
    if (config_.identity != nullptr) {
        own_uri_ = config_.identity->certificates.front().application_uri();
    }
    auto& all = config_.endpoints;
    auto ours = std::find_if(all.begin(), all.end(), [&](const auto& endpoint) {
        const auto url = channel::EndpointUrl::parse(endpoint.endpoint_url.view());
        return url && url->port == config_.server_url.port &&
               channel::is_same_host(url->host, config_.server_url.host);
    });
    if (ours == all.end()) { // the server has another name for its host
        ours = std::find_if(all.begin(), all.end(), [&](const auto& endpoint) {
            return is_of_server(endpoint.endpoint_url.view());
        });
    }
    if (ours == all.end()) { // a port map gave the server another port
        ours = all.begin();
        is_any_port_ours_ = true;
    }
    if (!all.empty()) {
        server_uri_ = ours->server.application_uri;
    }
    std::erase_if(all, [&](const auto& endpoint) { return !is_of_server(endpoint); });
}

std::vector<channel::SecuritySetting> ProxyEndpoints::settings() const
{
    std::vector<channel::SecuritySetting> settings{{}};
    for (const EndpointDescription& endpoint : config_.endpoints) {
        const auto setting = setting_of(endpoint);
        const bool is_possible =
            setting && (setting->policy->is_none() ||
                        (config_.identity != nullptr && certificate_for(*setting).has_value()));
        if (is_possible &&
            std::find(settings.begin(), settings.end(), *setting) == settings.end()) {
            settings.push_back(*setting);
        }
    }
    return settings;
}

std::optional<crypto::Certificate>
ProxyEndpoints::certificate_for(const channel::SecuritySetting& security) const
{
    for (const EndpointDescription& endpoint : config_.endpoints) {
        if (is_for(endpoint, security)) {
            if (auto chain = crypto::parse_chain(endpoint.server_certificate.span())) {
                return std::move(chain->front());
            }
        }
    }
    return std::nullopt;
}

const crypto::SecurityPolicy* ProxyEndpoints::token_policy(const channel::SecuritySetting& security,
                                                           const String& policy_id) const
{
    const crypto::SecurityPolicy* found = security.policy;
    for (const EndpointDescription& endpoint : config_.endpoints) {
        if (!is_for(endpoint, security)) {
            continue;
        }
        for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
            if (policy.policy_id == policy_id && !policy.security_policy_uri.empty()) {
                found = crypto::find_policy(policy.security_policy_uri.view());
            }
        }
    }
    return found != nullptr && !found->is_none() ? found : nullptr;
}

bool ProxyEndpoints::is_of_server(std::string_view url) const
{
    const auto parsed = channel::EndpointUrl::parse(url);
    return parsed && (is_any_port_ours_ || parsed->port == config_.server_url.port);
}

bool ProxyEndpoints::is_of_server(const EndpointDescription& endpoint) const
{
    return endpoint.server.application_uri == server_uri_ &&
           is_of_server(endpoint.endpoint_url.view());
}

void ProxyEndpoints::rewrite_url(String& url) const
{
    if (is_of_server(url.view())) {
        const auto parsed = channel::EndpointUrl::parse(url.view());
        url = String{config_.proxy_url + parsed->path};
    }
}

void ProxyEndpoints::rewrite(ApplicationDescription& server) const
{
    if (server.application_uri.view() != server_uri_) {
        return; // another server, which a discovery server knows
    }
    if (!own_uri_.empty()) {
        server.application_uri = String{own_uri_};
    }
    for (String& url : server.discovery_urls) {
        rewrite_url(url);
    }
}

void ProxyEndpoints::rewrite(Array<EndpointDescription>& endpoints) const
{
    const auto known = settings();
    Array<EndpointDescription> kept;
    for (EndpointDescription& endpoint : endpoints) {
        const bool is_ours = is_of_server(endpoint);
        const auto setting = setting_of(endpoint);
        if (is_ours &&
            (!setting || std::find(known.begin(), known.end(), *setting) == known.end())) {
            continue;
        }
        if (is_ours) {
            rewrite_url(endpoint.endpoint_url);
            rewrite(endpoint.server);
            if (!endpoint.server_certificate.empty()) {
                endpoint.server_certificate = own_chain_;
            }
        }
        kept.push_back(std::move(endpoint));
    }
    endpoints = std::move(kept);
}

} // namespace busbar::harness::detail
