#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program_files.hpp>
#include <busbar/core/function_ref.hpp>

#include "commands.hpp"
#include "controller/life/checksum.hpp"
#include "remote_files.hpp"
#include "remote_transfer.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

namespace program {
namespace {

constexpr std::size_t max_program = controller::DeclarationLimits{}.max_text_size;
constexpr std::size_t max_report = 256U << 20U;

RemoteTransfer transfer_of(Connection& connection)
{
    return {connection, "Program",
            "the controller has no program, which [machine] gives it, or this user may not see it: "
            "log in as one with the role Engineer, ConfigureAdmin or SecurityAdmin"};
}

Json answer_of(RemoteTransfer& transfer, const char* what)
{
    return transfer.answer(what, max_report);
}

bool is_true(const Json& json, std::string_view name)
{
    const Json* const found = json.find(name);
    return found != nullptr && found->kind == Json::Kind::True;
}

/// Sends the file to the controller. Reports the reason of a refusal, which the status does not
/// tell.
void send(Context& context, RemoteTransfer& transfer, const std::string& wish,
          const std::string& file)
{
    try {
        transfer.send(Variant{String{wish}}, file,
                      [&](std::size_t done) { show_progress(context, done, file.size()); });
    } catch (const Failure& failure) {
        std::string reason = failure.reason;
        if (reason.empty()) {
            try {
                reason = text_in(answer_of(transfer, "report"), "problem");
            } catch (const Failure&) {
                // Refused before the file was looked at: explain the status.
            }
        }
        if (reason.empty()) {
            throw;
        }
        throw Failure{Exit::Failed, safe_line(reason), "nothing was changed"};
    }
}

/// Reads the program in a file, in a folder or in the files of a .plcproj.
std::string read_program(const std::string& path)
{
    auto text = controller::read_program_files(path, max_program);
    if (!text) {
        throw Failure{Exit::Failed, busbar::text(text.error())};
    }
    return *std::move(text);
}

/// Sends the program in the file with this verb and the file's name.
void send_file(Context& context, RemoteTransfer& transfer, const std::string& verb,
               const std::string& path, const std::string& file)
{
    const std::filesystem::path place{path};
    const std::filesystem::path& named = place.has_filename() ? place : place.parent_path();
    send(context, transfer, verb + " " + named.filename().string(), file);
}

void send_file(Context& context, RemoteTransfer& transfer, const std::string& verb,
               const std::string& path)
{
    send_file(context, transfer, verb, path, read_program(path));
}

/// Reads the controller's status over a new connection; nothing if that fails.
std::optional<Json> status_now(Context& context)
{
    try {
        Connection connection{context};
        RemoteTransfer transfer = transfer_of(connection);
        return answer_of(transfer, "status");
    } catch (const Failure&) {
        return std::nullopt;
    }
}

/// Waits after a download until the controller, which ends all sessions, has the wanted status.
/// False after a timeout; throws Failure for a refusal.
bool wait_for(Context& context, Connection& connection, FunctionRef<bool(const Json&)> is_wanted)
{
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds pause{100};
    connection.close();
    for (const auto end = Clock::now() + std::chrono::seconds{10}; Clock::now() < end;) {
        const auto status = status_now(context);
        const std::string refusal = status ? text_in(*status, "refusal") : std::string{};
        if (!refusal.empty()) {
            throw Failure{Exit::Failed, safe(refusal), "the program from before goes on"};
        }
        if (status && is_wanted(*status)) {
            return true;
        }
        std::this_thread::sleep_for(pause);
    }
    return false;
}

std::string source_text(const Json& status)
{
    const std::string file = safe(text_in(status, "file"));
    const bool is_other = is_true(status, "fileIsOther");
    if (text_in(status, "source") == "received") {
        return "sent over OPC UA by " + safe(text_in(status, "user")) + " at " +
               safe(text_in(status, "received")) + "; it is used instead of " + file +
               (is_other ? ", which is different or missing" : ", which is the same");
    }
    return file + (is_other ? ", which has changed since: SIGHUP or a restart takes it up" : "");
}

Exit show(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    if (!arguments.save_to.empty()) {
        if (std::error_code ignored; std::filesystem::exists(arguments.save_to, ignored)) {
            make_sure(context, arguments, "replace " + arguments.save_to + "?");
        }
        const std::string text = transfer.fetch(Variant{});
        write_file(arguments.save_to, text);
        return report(context, "the program was saved to " + arguments.save_to + ": " +
                                   std::to_string(text.size()) + " bytes");
    }
    const Json status = answer_of(transfer, "status");
    if (context.options.is_json) {
        JsonLine json;
        json.open_object();
        for (const char* name :
             {"name", "source", "file", "user", "received", "checksum", "mode", "refusal"}) {
            json.member(name, text_in(status, name));
        }
        for (const char* name : {"bytes", "variables", "published"}) {
            json.member(name, static_cast<std::int64_t>(std::stoll("0" + text_in(status, name))));
        }
        context.out.line(
            json.member("fileIsOther", is_true(status, "fileIsOther")).close_object().document());
        return Exit::Good;
    }
    const std::pair<const char*, std::string> facts[] = {
        {"program", safe(text_in(status, "name"))},
        {"from", source_text(status)},
        {"size", text_in(status, "bytes") + " bytes, checksum " + text_in(status, "checksum")},
        {"variables",
         text_in(status, "variables") + ", of which clients see " + text_in(status, "published")},
        {"mode", safe(text_in(status, "mode"))}};
    for (const auto& [name, text] : facts) {
        std::string line = std::string{name} + ":";
        line.resize(12, ' ');
        context.out.line(line + text);
    }
    if (const std::string refusal = text_in(status, "refusal"); !refusal.empty()) {
        context.out.line("refused:    " + safe(refusal));
    }
    return Exit::Good;
}

std::vector<std::string> left_out_of(const Json& verdict)
{
    std::vector<std::string> all;
    for (const Json& each : items_in(verdict, "leftOut")) {
        all.push_back(each.text);
    }
    return all;
}

/// Tells what the controller would leave out of the program in a file.
void tell_left_out(Context& context, const Json& verdict)
{
    const std::vector<std::string> all = left_out_of(verdict);
    for (const std::string& each : all) {
        context.err.line("left out: " + safe(each));
    }
    const std::size_t count = std::stoul("0" + text_in(verdict, "leftOutCount"));
    if (count > all.size()) {
        context.err.line("left out: " + std::to_string(count - all.size()) + " more");
    }
}

/// The verb for a program that may leave out more than the one that runs.
std::string verb_of(const AdminArguments& arguments, const std::string& verb)
{
    return arguments.leaves_out ? verb + "-leaving-out" : verb;
}

/// Asks the controller to check the program in a file, and prints what it would leave out.
Json checked(Context& context, RemoteTransfer& transfer, const AdminArguments& arguments)
{
    send_file(context, transfer, verb_of(arguments, "check"), arguments.words[0]);
    Json verdict = answer_of(transfer, "report");
    tell_left_out(context, verdict);
    return verdict;
}

Exit check(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    const Json verdict = checked(context, transfer, arguments);
    const std::string against_edit = text_in(verdict, "edit");
    const std::string against_download = text_in(verdict, "download");
    if (context.options.is_json) {
        JsonLine json;
        json.open_object().member("isSame", is_true(verdict, "same"));
        json.member("againstEdit", against_edit).member("againstDownload", against_download);
        context.out.line(json.key("leftOut").texts(left_out_of(verdict)).close_object().document());
        return Exit::Good;
    }
    const std::string file = safe(arguments.words[0]);
    if (is_true(verdict, "same")) {
        return report(context, file + " is the program that runs");
    }
    if (against_edit.empty()) {
        return report(context, file + " is right, and an online edit takes it");
    }
    return report(context, file + " is right, and takes a download: " + safe(against_edit) +
                               (against_download.empty() ? "" : "; " + safe(against_download)));
}

Exit compare(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    send_file(context, transfer, "compare", arguments.words[0]);
    const Json report = answer_of(transfer, "report");
    std::vector<Difference> differences;
    for (const Json& each : items_in(report, "differences")) {
        differences.push_back(
            {text_in(each, "what"), text_in(each, "file"), text_in(each, "controller")});
    }
    return print_differences(context, differences, {"WHAT", "FILE", "CONTROLLER", "not there"});
}

Exit edit(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    if (arguments.leaves_out) {
        static_cast<void>(checked(context, transfer, arguments));
    }
    make_sure(context, arguments, "Edit the program of the controller while it runs?");
    send_file(context, transfer, verb_of(arguments, "edit"), arguments.words[0]);
    return report(context, "edited online: clients stay connected");
}

Exit download(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    if (arguments.leaves_out) {
        static_cast<void>(checked(context, transfer, arguments));
    }
    make_sure(context, arguments,
              "Replace the program of the controller? Clients have to connect again.");
    const std::string file = read_program(arguments.words[0]);
    send_file(context, transfer, verb_of(arguments, "download"), arguments.words[0], file);
    const std::string wanted = controller::detail::checksum_text(file);
    const bool is_there = wait_for(context, connection, [&](const Json& status) {
        return text_in(status, "checksum") == wanted;
    });
    return report(context, is_there ? "downloaded: the controller runs the program"
                                    : "the controller has the program and takes it up: "
                                      "`busbar admin program show` tells when it has");
}

Exit restore(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    make_sure(context, arguments, "Go back to the program of the controller's own file?");
    send(context, transfer, verb_of(arguments, "restore"), {});
    static_cast<void>(wait_for(context, connection, [](const Json& status) {
        return text_in(status, "source") == "file";
    }));
    return report(context, "the program of the controller's file is used again");
}

} // namespace
} // namespace program

namespace mode {
namespace {

Exit change(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const auto& words = arguments.words;
    if (words.size() > 1 || (words.size() == 1 && words[0] != "run" && words[0] != "program")) {
        throw Failure{Exit::Usage, "this is not a mode", "expected run or program"};
    }
    RemoteTransfer transfer = program::transfer_of(connection);
    if (words.empty()) {
        const std::string now = text_in(program::answer_of(transfer, "status"), "mode");
        JsonLine json;
        json.open_object().member("mode", now).close_object();
        context.out.line(context.options.is_json ? json.document() : safe(now));
        return Exit::Good;
    }
    const std::string wanted = words[0] == "run" ? "RUN" : "PROGRAM";
    make_sure(context, arguments, "Put the controller into " + wanted + "?");
    program::send(context, transfer, "mode " + wanted, {});
    return report(context, "the controller is in " + wanted);
}

} // namespace
} // namespace mode

void add_program(CLI::App& admin, Run& run)
{
    Group group{admin, run, "program", "The program that a controller runs."};
    AdminArguments& arguments = group.arguments();
    const auto asks = [&](CLI::App* command) {
        command->add_flag("--yes", arguments.is_sure, "ask nothing");
        return command;
    };
    const auto leaves_out = [&](CLI::App* command) {
        command->add_flag(
            "--leave-out", arguments.leaves_out,
            "also if it has declarations that cannot be served or are wrong, and that "
            "the program that runs has not: they are left out");
        return command;
    };
    const auto takes_file = [](CLI::App* command) {
        command->get_option("FILE")->description(
            "server (optional), before a file with declarations, a folder or a .plcproj of such");
        return command;
    };
    asks(group.add("show", "Shows what runs, and where it is from.", 0, "URL", program::show))
        ->add_option("--save", arguments.save_to, "a file that the program is written to instead");
    leaves_out(
        takes_file(group.add("check", "Tells whether a controller would take a program, and how.",
                             1, "FILE", program::check)));
    takes_file(group.add("compare",
                         "Lists what differs between a program and that of a controller.", 1,
                         "FILE", program::compare));
    leaves_out(asks(takes_file(
        group.add("download", "Replaces the program, in PROGRAM mode, whole or not at all.", 1,
                  "FILE", program::download))));
    leaves_out(asks(takes_file(group.add(
        "edit", "Adds and deletes variables while the program runs.", 1, "FILE", program::edit))));
    leaves_out(asks(group.add("restore", "Goes back to the program of the controller's own file.",
                              0, "URL", program::restore)));
}

void add_mode(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    group
        .add_any("mode", "Shows a controller's operating mode, or changes it.", "[run|program]",
                 mode::change)
        ->add_flag("--yes", group.arguments().is_sure, "ask nothing");
}

} // namespace busbar::tool::admin
