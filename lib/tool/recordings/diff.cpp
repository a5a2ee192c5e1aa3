#include <memory>

#include "recording_file.hpp"
#include "tool/commands/commands.hpp"

namespace busbar::tool {

namespace {

struct DiffArguments {
    std::string before;
    std::string after;
    harness::ComparisonOptions options;
    std::string junit;
};

} // namespace

void add_diff(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("diff", "Says what differs between two recordings.");
    const auto arguments = std::make_shared<DiffArguments>();
    command->add_option("FILE", arguments->before, "the first recording")->required();
    command->add_option("OTHER", arguments->after, "the second one")->required();
    command->add_flag("--times", arguments->options.with_times, "compare times of values, too");
    command
        ->add_option("--tolerance", arguments->options.tolerance,
                     "numbers that differ by no more are the same")
        ->check(CLI::NonNegativeNumber);
    command->add_option("--junit", arguments->junit, "also as JUnit report")->type_name("FILE");
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            unmark(arguments->before);
            unmark(arguments->after);
            const auto before = harness::read_messages(read_recording_file(arguments->before));
            const auto after = harness::read_messages(read_recording_file(arguments->after));
            need_readable(arguments->before, before);
            need_readable(arguments->after, after);
            return print_differences(
                context, harness::compare_messages(before, after, arguments->options),
                arguments->before + " and " + arguments->after, arguments->junit);
        };
    });
}

} // namespace busbar::tool
