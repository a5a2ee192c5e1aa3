#include "recording_file.hpp"

#include <algorithm>

#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/junit.hpp"

namespace busbar::tool {

namespace {

/// Two hexadecimal digits for each byte that a recording may have, and its lines.
constexpr std::size_t max_recording_text = 256U << 20U;

} // namespace

void add_comparison_options(CLI::App& command, ComparisonArguments& arguments)
{
    command.add_flag("--times", arguments.options.with_times, "compare times of values, too");
    command
        .add_option("--tolerance", arguments.options.tolerance,
                    "numbers that differ by no more are the same")
        ->check(CLI::NonNegativeNumber);
    command.add_option("--junit", arguments.junit, "also as JUnit report")->type_name("FILE");
}

void add_keys_option(CLI::App& command, std::string& keys)
{
    command.add_option("--keys", keys, "decrypts channels with what --key-log has written")
        ->type_name("FILE");
}

harness::Recording read_recording_file(const std::string& path, const std::string& keys)
{
    auto recording = harness::read_recording(read_file(path, max_recording_text));
    if (!recording) {
        throw Failure{Exit::Usage,
                      path + ": found no recording; expected a file that begins with "
                             "\"busbar-recording 1\"",
                      "`busbar proxy --record FILE` writes one"};
    }
    if (!keys.empty()) {
        return harness::decrypted(*recording, read_file(keys, max_key_log));
    }
    return *std::move(recording);
}

bool check_readable(Context& context, const std::string& path,
                    const std::vector<harness::RecordedMessage>& messages, const std::string& keys)
{
    const bool has_some =
        std::any_of(messages.begin(), messages.end(), [](const harness::RecordedMessage& message) {
            return !message.fields.empty();
        });
    const auto secured = std::count_if(
        messages.begin(), messages.end(),
        [](const harness::RecordedMessage& message) { return message.name == "MSG"; });
    const std::string advice = keys.empty()
                                   ? "let `busbar proxy` end the channels, or give their --keys"
                                   : keys + ": these keys are not those of its channels";
    if (!has_some) {
        throw Failure{Exit::Usage, path + ": no message in it can be read",
                      "its channels were secured, or there were none; " + advice};
    }
    if (secured != 0) {
        context.warn("warning", path + ": " + std::to_string(secured) +
                                    " messages are secured and not compared; " + advice);
    }
    return secured == 0;
}

void print_message(Context& context, const harness::RecordedMessage& message)
{
    if (!context.options.is_json) {
        context.out.line(std::to_string(message.number) + "  " + safe(harness::summary(message)));
        return;
    }
    JsonLine json;
    json.open_object().member("message", static_cast<std::int64_t>(message.number));
    json.member("time", std::chrono::duration<double>{message.time}.count());
    json.member("connection", static_cast<std::int64_t>(message.connection));
    json.member("from", message.from == harness::Side::Client ? "client" : "server");
    json.member("name", message.name).key("fields").open_object();
    for (const harness::RecordedMessage::Field& field : message.fields) {
        json.member(field.path, field.text);
    }
    context.out.line(json.close_object().close_object().document());
}

void write_differences_report(const std::vector<std::string>& differences, std::string_view title,
                              const ComparisonArguments& arguments)
{
    if (arguments.junit.empty()) {
        return;
    }
    JunitCase compared;
    compared.class_name = "busbar";
    compared.name = title;
    if (!differences.empty()) {
        compared.outcome = JunitCase::Outcome::Failed;
        compared.message = "differences: " + std::to_string(differences.size());
        for (const std::string& line : differences) {
            compared.details += line + "\n";
        }
    }
    const std::string report = junit_report("busbar", {{"differences", {compared}}});
    arguments.is_secret ? write_secret_file(arguments.junit, report)
                        : write_file(arguments.junit, report);
}

Exit print_differences(Context& context, const std::vector<std::string>& differences,
                       std::string_view title, const ComparisonArguments& arguments)
{
    if (context.options.is_json) {
        JsonLine json;
        json.open_object().key("differences").texts(differences);
        context.out.line(json.close_object().document());
    } else {
        for (const std::string& line : differences) {
            context.out.line(safe(line));
        }
    }
    write_differences_report(differences, title, arguments);
    return differences.empty() ? Exit::Good : Exit::Failed;
}

} // namespace busbar::tool
