#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/machine_event.hpp>

#include "commands.hpp"
#include "remote.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool::admin {

namespace event_log {
namespace {

using controller::MachineEvent;

constexpr std::size_t most_events = 100'000;
/// Maximum size of one file: see MachineEventLogOptions.
constexpr std::size_t max_size = 64U << 20U;
constexpr std::int32_t piece_size = 32'768;
/// Number of times that a file may change while it is read.
constexpr unsigned most_changes = 100;

/// Returns a NodeId in the server's own namespace. It is known rather than looked up, because a
/// server that has failed answers Read and Call only (see RunningServer::change_state).
NodeId node_of(const std::string& name)
{
    return NodeId{1, String{"Files/EventLog/" + name}};
}

/// Returns a Method, which all files of a folder share.
NodeId method_of(const char* name)
{
    return NodeId{1, String{"FileTypes/EventLog//" + std::string{name}}};
}

/// Appends the next piece of the file; false at the end.
bool read_piece(Connection& connection, const std::string& name, const Variant& handle,
                std::string& text)
{
    const auto piece = call(connection, node_of(name), method_of("Read"),
                            {handle, Variant{piece_size}}, "reading the event log");
    const auto* const part = piece.empty() ? nullptr : piece.front().get_if<ByteString>();
    if (part == nullptr || part->span().empty()) {
        return false;
    }
    if (text.size() > max_size) {
        throw Failure{status::Bad_EncodingLimitsExceeded, "reading the event log"};
    }
    text.append(reinterpret_cast<const char*>(part->span().data()), part->span().size());
    return true;
}

/// Reads the file once, provided that it does not change in the meantime.
std::string fetch_once(Connection& connection, const std::string& name)
{
    constexpr std::uint8_t for_reading = 1;
    const auto opened = call(connection, node_of(name), method_of("Open"), {Variant{for_reading}},
                             "opening the event log");
    const Variant handle = opened.empty() ? Variant{} : opened.front();
    std::string text;
    while (read_piece(connection, name, handle, text)) {
    }
    call(connection, node_of(name), method_of("Close"), {handle}, "closing the event log");
    return text;
}

/// Reads the file; empty if it does not exist.
std::string fetch(Connection& connection, const std::string& name)
{
    if (read(connection, node_of(name + "//Size")).is_null()) {
        return {};
    }
    for (unsigned changes = 0;; ++changes) {
        try {
            return fetch_once(connection, name);
        } catch (const Failure& failure) {
            if (failure.status != status::Bad_InvalidState || changes == most_changes) {
                throw;
            }
        }
    }
}

/// Reads all events, oldest first.
std::vector<MachineEvent> fetch_all(Connection& connection)
{
    const std::string now = fetch(connection, "events.log");
    std::string all = fetch(connection, "events_before.log");
    if (now.empty() && all.empty()) {
        throw Failure{Exit::Failed, "the server shares no event log, or this user may not see it",
                      "a busbar-controller with a program has one, over encrypted connections and "
                      "for users with the role Operator, Supervisor, Engineer, ConfigureAdmin or "
                      "SecurityAdmin"};
    }
    std::vector<MachineEvent> events = controller::read_machine_events(all + now);
    // A file that was replaced in the meantime is read twice.
    std::stable_sort(events.begin(), events.end(),
                     [](const auto& a, const auto& b) { return a.number < b.number; });
    const auto end = std::unique(events.begin(), events.end(),
                                 [](const auto& a, const auto& b) { return a.number == b.number; });
    events.erase(end, events.end());
    return events;
}

std::string folded(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return text;
}

bool fits(const MachineEvent& event, const PastEventChoice& choice)
{
    return (choice.level.empty() ||
            folded(std::string{name(event.level)}) == folded(choice.level)) &&
           (choice.code.empty() || folded(code_text(*event.type)) == folded(choice.code));
}

void check_code(const std::string& code)
{
    const char* const end = code.data() + code.size();
    std::uint32_t number = 0;
    const auto read = std::from_chars(code.data(), end, number, 16);
    constexpr std::size_t digits = 8;
    if (!code.empty() && (code.size() != digits || read.ec != std::errc{} || read.ptr != end)) {
        throw Failure{Exit::Usage, safe(code) + ": is not an event code",
                      "expected eight hexadecimal digits such as 35D00000"};
    }
}

void append(JsonLine& json, const MachineEvent& event)
{
    json.open_object().member("number", static_cast<std::int64_t>(event.number));
    json.member("time", event.time).member("code", code_text(*event.type));
    json.member("name", event.type->name).member("level", name(event.level));
    json.key("attached").texts(event.attached);
    json.member("source", source_details(*event.type)).member("meaning", event.type->meaning);
    json.member("cause", event.type->cause).member("correction", event.type->correction);
    json.close_object();
}

void print(Context& context, const MachineEvent& event)
{
    constexpr std::size_t indent = 4;
    constexpr std::size_t to_seconds = 19; // "2017-10-17T14:52:50"
    const auto more = [&](const char* title, std::string_view what) {
        if (!what.empty()) {
            const std::size_t columns = std::max(context.out.columns(), 4 * indent);
            context.out.line(std::string(indent, ' ') +
                             wrap(title + std::string{what}, columns - indent, 2 * indent));
        }
    };
    context.out.line(context.out.styled(Style::Bold, to_string(event.time).substr(0, to_seconds) +
                                                         "Z  " + std::string{name(event.level)} +
                                                         "  " + safe(text(event))));
    more("", event.type->meaning);
    more("Cause: ", event.type->cause);
    more("Correction: ", event.type->correction);
}

Exit show(Context& context, Connection& connection, const AdminArguments& arguments)
{
    check_code(arguments.events.code);
    std::vector<MachineEvent> events = fetch_all(connection);
    std::erase_if(events, [&](const auto& each) { return !fits(each, arguments.events); });
    const std::size_t surplus = events.size() - std::min(events.size(), arguments.events.count);
    events.erase(events.begin(), std::next(events.begin(), static_cast<std::ptrdiff_t>(surplus)));
    if (context.options.is_json) {
        JsonLine json;
        json.open_array();
        for (const MachineEvent& each : events) {
            append(json, each);
        }
        context.out.line(json.close_array().document());
        return Exit::Good;
    }
    if (events.empty()) {
        context.out.line("No events");
    }
    for (const MachineEvent& each : events) {
        print(context, each);
    }
    if (surplus != 0) {
        context.err.line("busbar: there are " + std::to_string(surplus) +
                         " older ones: --last N shows more");
    }
    return Exit::Good;
}

} // namespace
} // namespace event_log

void add_events(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    PastEventChoice& choice = group.arguments().events;
    auto* command =
        group.add("events", "Shows the event log of a controller.", 0, "URL", event_log::show);
    command
        ->add_option("--level", choice.level,
                     "only \"major fault\", \"partial fault\", \"minor fault\", observation or "
                     "information")
        ->transform(CLI::IsMember(
            {"major fault", "partial fault", "minor fault", "observation", "information"},
            CLI::ignore_case))
        ->type_name("LEVEL");
    command->add_option("--code", choice.code, "only this event code")->type_name("CODE");
    command->add_option("-n,--last", choice.count, "the last N, 20 if it is not given")
        ->check(CLI::Range(std::size_t{1}, event_log::most_events))
        ->type_name("N");
}

} // namespace busbar::tool::admin
