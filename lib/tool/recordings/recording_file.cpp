#include "recording_file.hpp"

#include <algorithm>

#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool {

namespace {

/// Two hexadecimal digits for each byte that a recording may have, and its lines.
constexpr std::size_t max_recording_text = 256U << 20U;

/// XML 1.0, 2.4.
std::string escaped(std::string_view text)
{
    std::string result;
    for (const char c : text) {
        switch (c) {
        case '&':
            result += "&amp;";
            break;
        case '<':
            result += "&lt;";
            break;
        case '"':
            result += "&quot;";
            break;
        default:
            result += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? '?' : c;
        }
    }
    return result;
}

} // namespace

harness::Recording read_recording_file(const std::string& path)
{
    auto recording = harness::read_recording(read_file(path, max_recording_text));
    if (!recording) {
        throw Failure{Exit::Usage,
                      path + ": found no recording; expected a file that begins with "
                             "\"busbar-recording 1\"",
                      "`busbar proxy --record FILE` writes one"};
    }
    return *std::move(recording);
}

void need_readable(const std::string& path, const std::vector<harness::RecordedMessage>& messages)
{
    const bool has_some =
        std::any_of(messages.begin(), messages.end(), [](const harness::RecordedMessage& message) {
            return !message.fields.empty();
        });
    if (!has_some) {
        throw Failure{Exit::Usage, path + ": no message in it can be read",
                      "its channels were secured, or there were none; record policy None"};
    }
}

void write_recording_file(const std::string& path, const harness::Recording& recording)
{
    write_file(path, harness::write_recording(recording));
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

Exit print_differences(Context& context, const std::vector<std::string>& differences,
                       std::string_view title, const std::string& junit)
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
    if (!junit.empty()) {
        std::string lines;
        for (const std::string& line : differences) {
            lines += escaped(line) + "\n";
        }
        const std::string failures = differences.empty() ? "0" : "1";
        write_file(junit, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"busbar\" "
                          "tests=\"1\" failures=\"" +
                              failures + "\">\n  <testcase name=\"" + escaped(title) + "\">" +
                              (differences.empty() ? std::string{}
                                                   : "<failure message=\"differences: " +
                                                         std::to_string(differences.size()) +
                                                         "\">" + lines + "</failure>") +
                              "</testcase>\n</testsuite>\n");
    }
    return differences.empty() ? Exit::Good : Exit::Failed;
}

} // namespace busbar::tool
