#include <memory>

#include <busbar/harness/request_replay.hpp>

#include "live_security.hpp"
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
    std::string keys;
    ComparisonArguments comparison;
};

Exit replay_to(Context& context, const ReplayArguments& arguments)
{
    const std::string& file = arguments.places.back();
    const harness::Recording recording = read_recording_file(file, arguments.keys);
    const auto before = harness::repeated_messages(recording);
    const bool is_readable =
        check_readable(context, file, harness::read_messages(recording), arguments.keys);
    if (before.empty()) {
        throw Failure{Exit::Usage, file + ": no request in it can be repeated"};
    }
    context.options.url = complete_url(context.options.url);
    LiveSecurity security{context};
    const auto config = security.session_config(endpoints_of(context));
    harness::RealWorld world;
    if (const auto reached = world.reach(context.options.url); !reached) {
        throw Failure{reached.error(), context.options.url};
    }
    harness::RequestReplayOptions options;
    options.keeps_pace = arguments.keeps_pace;
    options.answer_limit = std::chrono::duration_cast<Duration>(
        std::chrono::duration<double>{context.options.timeout});
    const auto came =
        harness::replay_requests(world, recording, config, security.client_parts(), options);
    if (!came) {
        throw Failure{came.error(), context.options.url};
    }
    ComparisonArguments comparison = arguments.comparison;
    comparison.is_secret = !arguments.keys.empty();
    return exit_of_comparison(
        print_differences(context, harness::compare_messages(before, *came, comparison.options),
                          file + " at " + context.options.url, comparison),
        is_readable);
}

Exit serve(Context& context, const ReplayArguments& arguments)
{
    const harness::Recording recording =
        read_recording_file(arguments.places.back(), arguments.keys);
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
    command->add_option("FILE", arguments->places, "server (optional), then a recording")
        ->required();
    command->add_option("--serve", arguments->serve, "answers clients instead, as was recorded")
        ->type_name("[ADDRESS:]PORT");
    command->add_option("--for", arguments->seconds, "with --serve: ends after so many seconds");
    command->add_flag("--pace", arguments->keeps_pace, "leaves the recorded time between requests");
    add_keys_option(*command, arguments->keys);
    add_comparison_options(*command, arguments->comparison);
    when_chosen(*command, run, [arguments](Context& context) {
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
    });
}

} // namespace busbar::tool
