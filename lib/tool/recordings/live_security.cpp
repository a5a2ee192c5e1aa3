#include "live_security.hpp"

#include <utility>

#include <busbar/channel/server_certificate.hpp>
#include <busbar/client/endpoint_choice.hpp>

#include "tool/connection/credentials.hpp"
#include "tool/connection/discovery.hpp"
#include "tool/connection/logs.hpp"

namespace busbar::tool {

Array<EndpointDescription> endpoints_of(Context& context)
{
    DiscoveryConnection connection{context};
    GetEndpointsRequest request;
    request.endpoint_url = String{connection.url()};
    return connection.call<GetEndpointsResponse>(std::move(request)).endpoints;
}

LiveSecurity::LiveSecurity(Context& context)
    : context_{&context}, log_{context.options.is_verbose},
      credentials_{context, log_}, key_log_{open_key_log(context, log_)}
{
}

void LiveSecurity::need_trust(const EndpointDescription& endpoint)
{
    const auto* const policy = crypto::find_policy(endpoint.security_policy_uri.view());
    if (policy == nullptr || policy->is_none()) {
        return;
    }
    const auto chain = crypto::parse_chain(endpoint.server_certificate.span());
    if (!chain) {
        throw Failure{chain.error(), context_->options.url + ": the certificate of an endpoint"};
    }
    const channel::ChannelEnvironment environment{
        .random = &random_, .wall_clock = &clock_, .log = &log_, .validator = &credentials_};
    for (bool is_first = true;; is_first = false) {
        if (channel::validate_server(environment, *chain, *policy,
                                     endpoint.server.application_uri.view(),
                                     context_->options.url)) {
            return;
        }
        if (!is_first || !credentials_.reconsider()) {
            throw credentials_.failure();
        }
    }
}

client::ConnectionConfig LiveSecurity::session_config(const Array<EndpointDescription>& endpoints)
{
    const Options& options = context_->options;
    client::SecurityWishes wishes;
    wishes.policies = options.policies;
    wishes.min_mode =
        options.mode == "Sign" ? MessageSecurityMode::Sign : MessageSecurityMode::SignAndEncrypt;
    wishes.allows_none = options.is_insecure;
    client::ConnectionConfig config;
    config.identity = user_of(*context_);
    const auto choice =
        client::choose_endpoint(endpoints, wishes, config.identity, options.url, log_);
    if (!choice) {
        throw connect_failure(choice.error(), options.url, "");
    }
    need_trust(choice->endpoint);
    if (choice->policy->is_none()) {
        context_->warn("insecure", "no encryption, and the server is not authenticated");
    }
    config.channel.endpoint_url = options.url;
    config.channel.security = {choice->policy, choice->endpoint.security_mode};
    config.channel.expected_server_uri = choice->endpoint.server.application_uri.view();
    if (auto chain = crypto::parse_chain(choice->endpoint.server_certificate.span())) {
        config.channel.server_certificate = std::move(chain->front());
    }
    config.token_policy = choice->token_policy;
    config.application_uri = credentials_.application_uri();
    config.application_name = "busbar";
    config.session_name = "busbar";
    return config;
}

harness::ClientParts LiveSecurity::client_parts()
{
    harness::ClientParts parts;
    parts.validator = &credentials_;
    parts.identity = credentials_.identity();
    parts.log = &log_;
    parts.random = &random_;
    parts.key_log = key_log_.get();
    return parts;
}

} // namespace busbar::tool
