#include <memory>

#include "recording_file.hpp"
#include "tool/commands/commands.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

struct ShowArguments {
    std::string file;
    std::string filter;
    bool has_fields{false};
    std::string pcap;
};

/// The name, or a text in one of the fields.
bool is_wanted(const harness::RecordedMessage& message, const std::string& filter)
{
    if (filter.empty() || message.name.find(filter) != std::string::npos) {
        return true;
    }
    for (const harness::RecordedMessage::Field& field : message.fields) {
        if ((field.path + " " + field.text).find(filter) != std::string::npos) {
            return true;
        }
    }
    return false;
}

Exit show(Context& context, const ShowArguments& arguments)
{
    const harness::Recording recording = read_recording_file(arguments.file);
    if (!arguments.pcap.empty()) {
        const auto bytes = harness::to_pcap(recording);
        write_file(arguments.pcap, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }
    std::vector<harness::RecordedMessage> wanted;
    for (harness::RecordedMessage& message : harness::read_messages(recording)) {
        if (is_wanted(message, arguments.filter)) {
            wanted.push_back(std::move(message));
        }
    }
    if (arguments.has_fields && !context.options.is_json) {
        context.out.write(harness::write_messages(wanted));
        return Exit::Good;
    }
    for (const harness::RecordedMessage& message : wanted) {
        print_message(context, message);
    }
    return Exit::Good;
}

} // namespace

void add_show(CLI::App& app, Run& run)
{
    auto* command = app.add_subcommand("show", "Shows the messages of a recording.");
    const auto arguments = std::make_shared<ShowArguments>();
    command->add_option("FILE", arguments->file, "written by `busbar proxy --record`")->required();
    command->add_option("--filter", arguments->filter, "only messages with this in name or fields")
        ->type_name("TEXT");
    command->add_flag("--fields", arguments->has_fields,
                      "all fields, with symbols for what differs from run to run");
    command->add_option("--pcap", arguments->pcap, "also as capture file for Wireshark")
        ->type_name("FILE");
    command->callback([&run, arguments] {
        run = [arguments](Context& context) {
            unmark(arguments->file);
            return show(context, *arguments);
        };
    });
}

} // namespace busbar::tool
