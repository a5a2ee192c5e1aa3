#include <memory>

#include "message_filter.hpp"
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
    std::string pcapng;
    std::string keys;
};

/// Only the owner may read what a recording has, also if it was recorded decrypted.
void write_capture(const std::string& path, const std::vector<std::byte>& bytes)
{
    write_secret_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Exit show(Context& context, const ShowArguments& arguments)
{
    const harness::Recording recording = read_recording_file(arguments.file, arguments.keys);
    if (!arguments.pcap.empty()) {
        write_capture(arguments.pcap, harness::to_pcap(recording));
    }
    if (!arguments.pcapng.empty()) {
        // As it was sent, with the keys in front.
        write_capture(arguments.pcapng,
                      harness::to_pcapng(read_recording_file(arguments.file),
                                         arguments.keys.empty()
                                             ? std::string{}
                                             : read_file(arguments.keys, max_key_log)));
    }
    MessageFilter filter{arguments.filter};
    std::vector<harness::RecordedMessage> wanted;
    for (harness::RecordedMessage& message : harness::read_messages(recording)) {
        if (filter.is_wanted(message)) {
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
    command
        ->add_option("--filter", arguments->filter,
                     "only some: a text in them, or \"service=Read and status!=Good\"")
        ->type_name("TEXT");
    add_keys_option(*command, arguments->keys);
    command->add_flag("--fields", arguments->has_fields,
                      "all fields, with symbols for what differs from run to run");
    command->add_option("--pcap", arguments->pcap, "also as capture file for Wireshark")
        ->type_name("FILE");
    command
        ->add_option("--pcapng", arguments->pcapng,
                     "the same as it was sent, with the --keys, for Wireshark 4.4 and later")
        ->type_name("FILE");
    when_chosen(*command, run, [arguments](Context& context) {
        unmark(arguments->file);
        return show(context, *arguments);
    });
}

} // namespace busbar::tool
