#include <memory>

#include "recording_file.hpp"
#include "server_diff.hpp"
#include "tool/commands/commands.hpp"

namespace busbar::tool {

namespace {

struct DiffArguments {
    std::string before;
    std::string after;
    std::string keys;
    bool ignores_values{false};
    ComparisonArguments comparison;
};

bool is_server(const std::string& place)
{
    return is_url(place) || (place.size() > 1 && place.front() == '@');
}

Exit diff(Context& context, const DiffArguments& arguments)
{
    ComparisonArguments comparison = arguments.comparison;
    comparison.is_secret = !arguments.keys.empty();
    const std::string title = arguments.before + " and " + arguments.after;
    if (is_server(arguments.before) != is_server(arguments.after)) {
        throw Failure{Exit::Usage, "found a server and a recording; expected two of a kind"};
    }
    if (is_server(arguments.before)) {
        return diff_servers(context, arguments.before, arguments.after, !arguments.ignores_values,
                            comparison);
    }
    const auto before =
        harness::read_messages(read_recording_file(arguments.before, arguments.keys));
    const auto after = harness::read_messages(read_recording_file(arguments.after, arguments.keys));
    const bool is_first_readable =
        check_readable(context, arguments.before, before, arguments.keys);
    const bool is_readable =
        check_readable(context, arguments.after, after, arguments.keys) && is_first_readable;
    return exit_of_comparison(
        print_differences(context, harness::compare_messages(before, after, comparison.options),
                          title, comparison),
        is_readable);
}

} // namespace

void add_diff(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand(
        "diff", "Says what differs between two recordings, or two servers' nodes and values.");
    const auto arguments = std::make_shared<DiffArguments>();
    command->add_option("FIRST", arguments->before, "a recording, or a server's URL")->required();
    command->add_option("SECOND", arguments->after, "another one")->required();
    command->add_flag("--no-values", arguments->ignores_values, "of servers, compare nodes alone");
    add_keys_option(*command, arguments->keys);
    add_comparison_options(*command, arguments->comparison);
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            unmark(arguments->before);
            unmark(arguments->after);
            return diff(context, *arguments);
        };
    });
}

} // namespace busbar::tool
