#include <memory>

#include <busbar/harness/request_replay.hpp>

#include "live_world.hpp"
#include "recording_file.hpp"
#include "tool/commands/commands.hpp"
#include "tool/printing/display_text.hpp"

namespace busbar::tool {

namespace {

struct ReplayArguments {
    std::vector<std::string> places;
    std::string serve;
    double seconds{0};
    bool keeps_pace{false};
    harness::ComparisonOptions options;
    std::string junit;
};

Exit replay_to(Context& context, const ReplayArguments& arguments)
{
    if (!context.options.is_insecure) {
        throw Failure{Exit::Usage, "a replay is sent without security",
                      "say --insecure if that is meant, for a test bench"};
    }
    const harness::Recording recording = read_recording_file(arguments.places.back());
    need_readable(arguments.places.back(), harness::repeated_messages(recording));
    harness::RealWorld world;
    if (const auto reached = world.reach(context.options.url); !reached) {
        throw Failure{reached.error(), context.options.url};
    }
    client::ConnectionConfig config = harness::open_connection_config();
    config.channel.endpoint_url = context.options.url;
    harness::RequestReplayOptions options;
    options.keeps_pace = arguments.keeps_pace;
    options.answer_limit = std::chrono::duration_cast<Duration>(
        std::chrono::duration<double>{context.options.timeout});
    const auto came = harness::replay_requests(world, recording, std::move(config), {}, options);
    if (!came) {
        throw Failure{came.error(), context.options.url};
    }
    return print_differences(
        context,
        harness::compare_messages(harness::repeated_messages(recording), *came, arguments.options),
        arguments.places.back() + " at " + context.options.url, arguments.junit);
}

Exit serve(Context& context, const ReplayArguments& arguments)
{
    const harness::Recording recording = read_recording_file(arguments.places.back());
    LiveWorld live;
    const std::string url = live.open(arguments.serve);
    const harness::RecordedServer server{live.world(), url, recording};
    context.err.line("busbar: " + url + " answers as " + safe(arguments.places.back()) +
                     " has recorded");
    live.run(arguments.seconds, [] {});
    const std::string report = server.report();
    if (!report.empty()) {
        context.err.write(report);
    }
    return report.empty() ? Exit::Good : Exit::Partly;
}

} // namespace

void add_replay(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "replay", "Sends a recording's requests again and says what differs, or serves it.");
    const auto arguments = std::make_shared<ReplayArguments>();
    command->add_option("FILE", arguments->places, "[URL] and a recording")->required();
    command->add_option("--serve", arguments->serve, "answers clients instead, as was recorded")
        ->type_name("[ADDRESS:]PORT");
    command->add_option("--for", arguments->seconds, "with --serve: ends after so many seconds");
    command->add_flag("--pace", arguments->keeps_pace, "leaves the recorded time between requests");
    command->add_flag("--times", arguments->options.with_times, "compare times of values, too");
    command
        ->add_option("--tolerance", arguments->options.tolerance,
                     "numbers that differ by no more are the same")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--junit", arguments->junit, "also as JUnit report")->type_name("FILE");
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            if (arguments->serve.empty()) {
                take_url(arguments->places, context.options, 1);
            } else {
                unmark(arguments->places.front());
            }
            if (arguments->places.size() != 1) {
                throw Failure{Exit::Usage, "one recording is to be given"};
            }
            return arguments->serve.empty() ? replay_to(context, *arguments)
                                            : serve(context, *arguments);
        };
    });
}

} // namespace busbar::tool
