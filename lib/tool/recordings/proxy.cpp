#include <array>
#include <memory>
#include <sstream>

#include <poll.h>
#include <unistd.h>

#include <busbar/channel/endpoint_url.hpp>
#include <busbar/harness/fault.hpp>
#include <busbar/types/discovery.hpp>
#include <busbar/types/session.hpp>

#include "live_world.hpp"
#include "recording_file.hpp"
#include "tool/commands/commands.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

struct ProxyArguments {
    std::vector<std::string> url;
    std::string listen{"127.0.0.1:0"};
    std::vector<std::string> faults;
    std::string faults_file;
    std::string record;
    double seconds{0};
    bool is_quiet{false};
    bool is_controlled{false};
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

harness::FaultScript faults_of(const ProxyArguments& arguments)
{
    harness::FaultScript script;
    if (!arguments.faults_file.empty()) {
        auto read = harness::read_faults(read_file(arguments.faults_file), arguments.faults_file);
        if (!read) {
            throw Failure{Exit::Usage, text(read.error())};
        }
        script = *std::move(read);
    }
    for (const std::string& one : arguments.faults) {
        auto fault = harness::parse_fault(one);
        if (!fault) {
            throw Failure{Exit::Usage, "--fault \"" + one + "\": " + fault.error().text};
        }
        script.push_back(*std::move(fault));
    }
    return script;
}

/// Plays faults as they come on standard input, one a line; a line that is none is told.
class Control {
public:
    /// Takes what is there, and never waits.
    void look(Context& context, harness::Network& network)
    {
        pollfd input{STDIN_FILENO, POLLIN, 0};
        std::array<char, 4'096> bytes{};
        while (!has_ended_ && ::poll(&input, 1, 0) > 0) {
            const auto size = ::read(STDIN_FILENO, bytes.data(), bytes.size());
            has_ended_ = size <= 0;
            rest_.append(bytes.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
        }
        for (std::size_t end = rest_.find('\n'); end != std::string::npos; end = rest_.find('\n')) {
            play(context, network, rest_.substr(0, end));
            rest_.erase(0, end + 1);
        }
        constexpr std::size_t max_line = 4'096;
        if (rest_.size() > max_line) {
            rest_.clear();
        }
    }

private:
    static void play(Context& context, harness::Network& network, const std::string& line)
    {
        const auto fault = harness::parse_fault(line);
        if (!fault) {
            context.err.line("busbar: " + safe(line) + ": " + fault.error().text);
            return;
        }
        network.play(*fault);
        context.err.line("busbar: played " + safe(harness::describe(*fault)));
    }

    std::string rest_;
    bool has_ended_{false};
};

/// Tells which of the user's faults have never acted; those of the proxy itself may not.
Exit report(Context& context, const harness::RealWorld& world, const harness::FaultScript& faults)
{
    std::istringstream pending{const_cast<harness::RealWorld&>(world).network().pending_faults()};
    Exit exit = Exit::Good;
    for (std::string line; std::getline(pending, line);) {
        const bool is_own = std::none_of(faults.begin(), faults.end(), [&](const auto& fault) {
            return harness::describe(fault) == line;
        });
        if (!is_own) {
            context.err.line("busbar: has never acted: " + safe(line));
            exit = Exit::Partly;
        }
    }
    return exit;
}

Exit run_proxy(Context& context, const ProxyArguments& arguments)
{
    const harness::FaultScript faults = faults_of(arguments);
    LiveWorld live;
    harness::RealWorld& world = live.world();
    const auto recorder = std::make_shared<harness::Recorder>(world.seed());
    world.network().set_observer(recorder);
    const std::string url = live.open(arguments.listen);
    if (const auto forwarded = world.forward(url, context.options.url); !forwarded) {
        throw Failure{forwarded.error(), context.options.url};
    }
    world.network().forgive_pending_faults();
    world.network().play(Rewriting{context.options.url, url}.script());
    world.network().play(faults);
    context.err.line("busbar: " + url + " leads to " + safe(context.options.url));
    harness::MessageReader reader;
    Control control;
    std::size_t next = 0;
    live.run(arguments.seconds, [&] {
        if (arguments.is_controlled) {
            control.look(context, world.network());
        }
        context.err.write(world.log().text());
        world.log().clear();
        const auto& entries = recorder->recording().entries;
        for (; next < entries.size(); ++next) {
            for (const harness::RecordedMessage& message : reader.feed(entries[next])) {
                if (!arguments.is_quiet) {
                    print_message(context, message);
                }
            }
        }
    });
    if (!arguments.record.empty()) {
        write_recording_file(arguments.record, recorder->recording());
    }
    if (!recorder->recording().is_complete) {
        context.err.line("busbar: there was more than a recording holds, 64 MiB");
    }
    return report(context, world, faults);
}

} // namespace

void add_proxy(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "proxy", "Lets clients reach a server through it; shows, records and disturbs messages.");
    const auto arguments = std::make_shared<ProxyArguments>();
    command->add_option("URL", arguments->url, "of the server");
    command->add_option("--listen", arguments->listen, "where clients connect (0: any port)")
        ->type_name("[ADDRESS:]PORT")
        ->capture_default_str();
    command->add_option("--fault", arguments->faults, "\"cut after PublishResponse 3\"; several")
        ->type_name("FAULT");
    command->add_option("--faults", arguments->faults_file, "a file of faults, one a line")
        ->type_name("FILE");
    command->add_option("--record", arguments->record, "for show, diff and replay")
        ->type_name("FILE");
    command->add_flag("--control", arguments->is_controlled,
                      "plays faults from standard input, one a line");
    command->add_option("--for", arguments->seconds, "ends after so many seconds");
    command->add_flag("--quiet", arguments->is_quiet, "does not show messages");
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            take_only_url(arguments->url, context.options);
            return run_proxy(context, *arguments);
        };
    });
}

} // namespace busbar::tool
