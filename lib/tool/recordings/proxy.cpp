#include <memory>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/harness/fault.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

#include "live_run.hpp"
#include "tool/commands/commands.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool {

namespace {

struct ProxyArguments {
    std::vector<std::string> url;
    LiveOptions live;
};

/// Lets clients stay on the proxy: URLs of the server in what discovery and sessions return become
/// the proxy's.
class Rewriting {
public:
    Rewriting(const std::string& server, std::string proxy)
        : server_{*channel::EndpointUrl::parse(server)}, proxy_{std::move(proxy)}
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
        for (String& url : server.discovery_urls) {
            rewrite(url);
        }
    }
    void rewrite(Array<EndpointDescription>& endpoints) const
    {
        for (EndpointDescription& endpoint : endpoints) {
            rewrite(endpoint.endpoint_url);
            rewrite(endpoint.server);
        }
    }

    channel::EndpointUrl server_;
    std::string proxy_;
};

Exit run_proxy(Context& context, const ProxyArguments& arguments)
{
    LiveRun live{context, arguments.live};
    harness::RealWorld& world = live.world();
    if (const auto forwarded = world.forward(live.url(), context.options.url); !forwarded) {
        throw Failure{forwarded.error(), context.options.url};
    }
    world.network().play(Rewriting{context.options.url, live.url()}.script());
    context.err.line("busbar: " + live.url() + " leads to " + safe(context.options.url));
    return live.run();
}

} // namespace

void add_proxy(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "proxy", "Lets clients reach a server through it; shows, records and disturbs messages.");
    const auto arguments = std::make_shared<ProxyArguments>();
    command->add_option("URL", arguments->url, "of the server");
    add_live_options(*command, arguments->live);
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            take_only_url(arguments->url, context.options);
            return run_proxy(context, *arguments);
        };
    });
}

} // namespace busbar::tool
