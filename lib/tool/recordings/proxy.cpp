#include <algorithm>
#include <memory>

#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/harness/fault.hpp>
#include <busbar/harness/secure_proxy.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

#include "live_run.hpp"
#include "live_security.hpp"
#include "tool/commands/commands.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool {

namespace {

struct ProxyArguments {
    std::vector<std::string> url;
    LiveOptions live;
    bool passes{false};
    bool has_any_client{false};
};

/// Lets clients stay on the proxy: URLs of the server in what discovery and sessions return become
/// the proxy's.
class Rewriting {
public:
    /// `server_uri` is the server's ApplicationUri; if empty, responses say it.
    Rewriting(const std::string& server, std::string server_uri, std::string proxy)
        : server_{*channel::EndpointUrl::parse(server)},
          server_uri_{std::make_shared<std::string>(std::move(server_uri))}, proxy_{
                                                                                 std::move(proxy)}
    {
    }
    [[nodiscard]] harness::FaultScript script() const
    {
        using harness::Message;
        const Rewriting self = *this;
        return {
            harness::fault::change<GetEndpointsResponse>(
                [self](GetEndpointsResponse& response) { self.rewrite(response.endpoints); })
                .at(Message{"GetEndpointsResponse"})
                .times(0),
            harness::fault::change<CreateSessionResponse>([self](CreateSessionResponse& response) {
                self.rewrite(response.server_endpoints);
            })
                .at(Message{"CreateSessionResponse"})
                .times(0),
            harness::fault::change<FindServersResponse>([self](FindServersResponse& response) {
                for (ApplicationDescription& server : response.servers) {
                    self.rewrite(server);
                }
            })
                .at(Message{"FindServersResponse"})
                .times(0)};
    }

private:
    void rewrite(String& url) const
    {
        const auto parsed = channel::EndpointUrl::parse(url.view());
        if (parsed && parsed->port == server_.port) {
            const std::size_t path = url.view().find('/', url.view().find("://") + 3);
            url = String{proxy_ + std::string{path == std::string_view::npos
                                                  ? std::string_view{}
                                                  : url.view().substr(path)}};
        }
    }
    void rewrite(ApplicationDescription& server) const
    {
        if (!server_uri_->empty() && server.application_uri.view() != *server_uri_) {
            return; // another server, which a discovery server knows
        }
        for (String& url : server.discovery_urls) {
            rewrite(url);
        }
    }
    void rewrite(Array<EndpointDescription>& endpoints) const
    {
        if (server_uri_->empty() && !endpoints.empty()) {
            *server_uri_ = endpoints[0].server.application_uri.view();
        }
        for (EndpointDescription& endpoint : endpoints) {
            rewrite(endpoint.endpoint_url);
            rewrite(endpoint.server);
        }
    }

    channel::EndpointUrl server_;
    /// Copies share it.
    std::shared_ptr<std::string> server_uri_;
    std::string proxy_;
};

/// The URL that clients are told: they cannot connect to "every address of this machine".
std::string public_url(const std::string& listening)
{
    for (const std::string_view every : {"//0.0.0.0:", "//[::]:"}) {
        if (const std::size_t at = listening.find(every); at != std::string::npos) {
            char name[256]{};
            const bool has_name = ::gethostname(name, sizeof name - 1) == 0 && name[0] != '\0';
            return "opc.tcp://" + std::string{has_name ? name : "localhost"} +
                   listening.substr(at + every.size() - 1);
        }
    }
    return listening;
}

/// Throws Failure for options that mean nothing if channels are not ended; `why` they are not.
void refuse_options_of_ends(const Context& context, const ProxyArguments& arguments,
                            const std::string& why)
{
    if (arguments.has_any_client) {
        throw Failure{Exit::Usage, "--any-client: " + why + ", so the proxy checks no client"};
    }
    if (!context.options.key_log.empty()) {
        throw Failure{Exit::Usage, "--key-log: " + why + ", so the proxy has no keys",
                      "let the client or the server write them"};
    }
}

/// Passes channels on as they are; `endpoints` are empty if they are not known.
Exit pass(Context& context, const ProxyArguments& arguments,
          const Array<EndpointDescription>& endpoints)
{
    refuse_options_of_ends(context, arguments,
                           arguments.passes ? "--pass passes channels on as they are"
                                            : "the server has no endpoint with security");
    const std::string server_uri{endpoints.empty() ? std::string_view{}
                                                   : endpoints[0].server.application_uri.view()};
    LiveRun live{context, arguments.live};
    harness::RealWorld& world = live.world();
    if (const auto forwarded = world.forward(live.url(), context.options.url); !forwarded) {
        throw Failure{forwarded.error(), context.options.url};
    }
    world.network().play(
        Rewriting{context.options.url, server_uri, public_url(live.url())}.script());
    context.err.line("busbar: " + live.url() + " leads to " + safe(context.options.url));
    return live.run();
}

/// Ends the channels of both sides.
Exit end_channels(Context& context, const ProxyArguments& arguments,
                  const Array<EndpointDescription>& endpoints)
{
    const std::string& url = context.options.url;
    LiveSecurity security{context};
    try {
        for (const EndpointDescription& endpoint : endpoints) {
            security.need_trust(endpoint);
        }
    } catch (Failure& failure) {
        failure.hint += "; or leave secured channels as they are: --pass";
        throw;
    }
    LiveRun live{context, arguments.live};
    harness::RealWorld& world = live.world();
    harness::SecureProxyParts parts;
    parts.identity = security.credentials().identity();
    parts.server_validator = &security.credentials();
    parts.client_validator = arguments.has_any_client ? nullptr : &security.credentials();
    parts.random = &security.random();
    parts.key_log = security.key_log();
    parts.public_url = public_url(live.url());
    const harness::SecureProxy proxy{world, live.url(), url, endpoints, parts};
    const auto reached = world.reach(url);
    if (!reached || !proxy.is_listening()) {
        throw Failure{reached ? StatusCode{status::Bad_TcpEndpointUrlInvalid} : reached.error(),
                      url};
    }
    if (arguments.has_any_client) {
        context.warn("insecure", "every client is accepted, and reaches the server as this proxy");
    }
    context.err.line("busbar: both sides have to trust its certificate, " +
                     security.credentials().own_file());
    context.err.line("busbar: " + live.url() + " leads to " + safe(url) + ", and ends channels");
    return live.run();
}

Exit run_proxy(Context& context, const ProxyArguments& arguments)
{
    context.options.url = complete_url(context.options.url);
    if (arguments.passes) {
        return pass(context, arguments, {});
    }
    Array<EndpointDescription> endpoints;
    try {
        endpoints = endpoints_of(context);
    } catch (Failure& failure) {
        failure.hint += "; with --pass the proxy begins without the server";
        throw;
    }
    const bool has_security =
        std::any_of(endpoints.begin(), endpoints.end(), [](const EndpointDescription& endpoint) {
            return endpoint.security_mode != MessageSecurityMode::None;
        });
    return has_security ? end_channels(context, arguments, endpoints)
                        : pass(context, arguments, endpoints);
}

} // namespace

void add_proxy(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "proxy", "Lets clients reach a server through it; shows, records and disturbs messages.");
    const auto arguments = std::make_shared<ProxyArguments>();
    command->add_option("URL", arguments->url, "the server to forward to");
    command->add_flag("--pass", arguments->passes,
                      "passes secured channels on as they are, which it cannot read");
    command->add_flag("--any-client", arguments->has_any_client,
                      "accepts clients whose certificate is not trusted");
    add_live_options(*command, arguments->live);
    when_chosen(*command, run, [arguments](Context& context) {
        take_only_url(arguments->url, context.options);
        return run_proxy(context, *arguments);
    });
}

} // namespace busbar::tool
