#include <memory>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/security_policy.hpp>
#include <busbar/types/discovery.hpp>

#include "commands.hpp"
#include "tool/connection/discovery.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool {

namespace {

std::string_view mode_name(MessageSecurityMode mode)
{
    const std::string_view name = channel::name(mode);
    return mode == MessageSecurityMode::Invalid || name.empty() ? "?" : name;
}

std::string_view token_name(UserTokenType type)
{
    switch (type) {
    case UserTokenType::Anonymous:
        return "anonymous";
    case UserTokenType::UserName:
        return "name";
    case UserTokenType::Certificate:
        return "certificate";
    case UserTokenType::IssuedToken:
        return "token";
    }
    return "?";
}

/// "Basic256Sha256", or the URI's end for a policy that this build does not know.
std::string policy_name(const String& uri)
{
    if (const crypto::SecurityPolicy* policy = crypto::find_policy(uri.view())) {
        return std::string{policy->name};
    }
    return safe(uri.view().substr(uri.view().find('#') + 1));
}

std::string tokens_of(const EndpointDescription& endpoint)
{
    std::string tokens;
    for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
        const std::string_view name = token_name(policy.token_type);
        if (tokens.find(name) == std::string::npos) {
            tokens += (tokens.empty() ? "" : ",") + std::string{name};
        }
    }
    return tokens.empty() ? "-" : tokens;
}

/// Returns the leaf of the certificates that an endpoint gives.
std::optional<crypto::Certificate> certificate_of(const EndpointDescription& endpoint)
{
    auto chain = crypto::parse_chain(endpoint.server_certificate.span());
    return chain ? std::optional{chain->front()} : std::nullopt;
}

std::string json_of(const Array<EndpointDescription>& endpoints)
{
    JsonLine json;
    json.open_array();
    for (const EndpointDescription& endpoint : endpoints) {
        json.open_object();
        json.member("url", endpoint.endpoint_url.view());
        json.member("mode", mode_name(endpoint.security_mode));
        json.member("policy", endpoint.security_policy_uri.view());
        json.member("level", std::int64_t{endpoint.security_level});
        json.key("users").open_array();
        for (const UserTokenPolicy& policy : endpoint.user_identity_tokens) {
            json.text(token_name(policy.token_type));
        }
        json.close_array();
        if (const auto certificate = certificate_of(endpoint)) {
            json.member("thumbprint", certificate->thumbprint_text());
        }
        json.member("transport", endpoint.transport_profile_uri.view());
        json.close_object();
    }
    return json.close_array().document();
}

Style mode_style(MessageSecurityMode mode)
{
    return mode == MessageSecurityMode::SignAndEncrypt ? Style::Good
           : mode == MessageSecurityMode::Sign         ? Style::Uncertain
                                                       : Style::Bad;
}

void print_certificates(Output& out, const Array<EndpointDescription>& endpoints)
{
    std::vector<crypto::Certificate> seen;
    for (const EndpointDescription& endpoint : endpoints) {
        const auto certificate = certificate_of(endpoint);
        if (!certificate || std::find(seen.begin(), seen.end(), *certificate) != seen.end()) {
            continue;
        }
        seen.push_back(*certificate);
        std::string hosts;
        for (const std::string& host : certificate->host_names()) {
            hosts += " " + safe(host);
        }
        out.line("certificate " + certificate->thumbprint_text());
        out.line("  subject  " + safe(certificate->subject()));
        out.line("  hosts   " + (hosts.empty() ? " none" : hosts));
        out.line("  valid    " + to_string(certificate->valid_from()) + " to " +
                 to_string(certificate->valid_to()));
    }
}

void print(Output& out, const Array<EndpointDescription>& endpoints)
{
    Table table{{{"MODE"}, {"POLICY"}, {"LEVEL", 5, true}, {"USERS"}, {"URL", 16}}};
    for (const EndpointDescription& endpoint : endpoints) {
        table.add(
            {{std::string{mode_name(endpoint.security_mode)}, mode_style(endpoint.security_mode)},
             {policy_name(endpoint.security_policy_uri)},
             {std::to_string(endpoint.security_level)},
             {tokens_of(endpoint)},
             {safe(endpoint.endpoint_url.view())}});
    }
    table.print(out);
    print_certificates(out, endpoints);
}

Exit show_endpoints(Context& context)
{
    DiscoveryConnection connection{context};
    GetEndpointsRequest request;
    request.endpoint_url = connection.url();
    const auto response = connection.call<GetEndpointsResponse>(std::move(request));
    if (context.options.is_json) {
        context.out.line(json_of(response.endpoints));
    } else {
        print(context.out, response.endpoints);
    }
    return Exit::Good;
}

} // namespace

void add_endpoints(CLI::App& app, Run& run)
{
    auto* command =
        app.add_subcommand("endpoints", "Shows what security and logins a server offers.");
    auto arguments = std::make_shared<std::vector<std::string>>();
    auto shows_claims = std::make_shared<bool>(false);
    command->add_option("URL", *arguments, "server");
    command->add_flag("--conformance", *shows_claims,
                      "the profiles that it claims, and what others lack; needs a session");
    when_chosen(*command, run, [arguments, shows_claims](Context& context) {
        take_only_url(*arguments, context.options);
        return *shows_claims ? show_claims(context) : show_endpoints(context);
    });
}

} // namespace busbar::tool
