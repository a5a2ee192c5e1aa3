#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "commands.hpp"
#include "lines.hpp"
#include "remote_log.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"

namespace busbar::tool::admin {

namespace log {
namespace {

constexpr std::size_t most_entries = 1'000'000;
/// --follow looks for what is new once in this time.
constexpr std::chrono::seconds follow_period{1};

controller::ExecutionLogFilter filter_of(const LogChoice& choice)
{
    controller::ExecutionLogFilter filter;
    filter.category = choice.category;
    filter.text = choice.text;
    if (!choice.code.empty()) {
        const char* const end = choice.code.data() + choice.code.size();
        std::uint16_t code = 0;
        const auto read = std::from_chars(choice.code.data(), end, code); // decimal: "0100" must
                                                                          // not be octal
        if (read.ec != std::errc{} || read.ptr != end) {
            throw Failure{Exit::Usage, safe(choice.code) + ": is not a log code",
                          "expected digits such as 0005"};
        }
        filter.code = code;
    }
    return filter;
}

void tell_damage(Context& context, std::size_t lines)
{
    if (lines != 0 && !context.options.is_json) {
        context.err.line("busbar: " + std::to_string(lines) +
                         (lines == 1 ? " line is" : " lines are") +
                         " damaged: see all with --save FOLDER");
    }
}

void tell_missing(Context& context, std::size_t records)
{
    if (records == 0) {
        return;
    }
    if (context.options.is_json) {
        JsonLine json;
        json.open_object().member("missing", static_cast<std::int64_t>(records));
        context.out.line(json.close_object().document());
    } else {
        context.err.line("busbar: " + std::to_string(records) +
                         (records == 1 ? " entry was" : " entries were") +
                         " removed before they could be shown: the log was cleared");
    }
}

void print_entries(Context& context, const std::vector<controller::ExecutionLogEntry>& entries)
{
    for (const controller::ExecutionLogEntry& entry : entries) {
        if (context.options.is_json) {
            JsonLine json;
            append_entry(json, entry);
            context.out.line(json.document());
        } else {
            context.out.line(log_line(entry, context.out.columns()));
        }
    }
}

void print_title(Context& context)
{
    if (!context.options.is_json) {
        context.out.line(context.out.styled(Style::Bold, log_title(context.out.columns())));
    }
}

void print_document(Context& context, const controller::ExecutionLogContents& contents)
{
    JsonLine json;
    json.open_object().key("entries").open_array();
    for (const controller::ExecutionLogEntry& entry : contents.entries) {
        append_entry(json, entry);
    }
    json.close_array().member("isCut", contents.is_cut);
    json.member("damaged", static_cast<std::int64_t>(contents.damaged));
    context.out.line(json.close_object().document());
}

Exit show(Context& context, RemoteLog& log, const LogChoice& choice)
{
    const auto contents = log.last(filter_of(choice), choice.count);
    if (context.options.is_json) {
        print_document(context, contents);
        return Exit::Good;
    }
    if (contents.entries.empty()) {
        context.out.line("No entries");
    } else {
        print_title(context);
        print_entries(context, contents.entries);
    }
    if (contents.is_cut) {
        context.err.line("busbar: there may be older ones: --count N shows more");
    }
    tell_damage(context, contents.damaged);
    return Exit::Good;
}

Exit follow(Context& context, Connection& connection, RemoteLog& log,
            const AdminArguments& arguments)
{
    using Clock = std::chrono::steady_clock;
    const auto filter = filter_of(arguments.log);
    const auto contents = log.last(filter, arguments.log.count);
    print_title(context);
    print_entries(context, contents.entries);
    tell_damage(context, contents.damaged);
    Stream stream{context, connection, arguments.end};
    auto next = Clock::now() + follow_period;
    stream.run([&] {
        if (Clock::now() < next || connection.client().state() != client::ClientState::Ready) {
            return;
        }
        next = Clock::now() + follow_period;
        try {
            log.fetch_new([&](const std::string& text, std::size_t missing) {
                tell_missing(context, missing);
                const auto fresh = controller::read_execution_log(text, filter, most_entries);
                print_entries(context, fresh.entries);
                tell_damage(context, fresh.damaged);
            });
        } catch (const Failure& failure) {
            if (failure.exit != Exit::NotConnected) {
                throw;
            } // otherwise the connection is restored, which the Stream reports
        }
    });
    return Exit::Good;
}

/// Saves the log; asks its question once, before fetching anything.
Exit save(Context& context, RemoteLog& log, const AdminArguments& arguments)
{
    const std::filesystem::path folder{arguments.log.folder};
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error && !std::filesystem::is_directory(folder)) {
        throw Failure{Exit::Failed, folder.string() + ": cannot be made: " + error.message()};
    }
    const std::vector<NamedChild> files = log.files();
    const auto there = std::count_if(files.begin(), files.end(), [&](const NamedChild& file) {
        return std::filesystem::exists(folder / file.name, error);
    });
    if (there != 0) {
        make_sure(context, arguments,
                  "replace " + std::to_string(there) + " files in " + folder.string() + "?");
    }
    std::size_t size = 0;
    for (const NamedChild& file : files) {
        const std::string text = log.fetch(file);
        write_file((folder / file.name).string(), text);
        size += text.size();
    }
    return report(context, "saved " + std::to_string(files.size()) +
                               " files of the execution log: " + std::to_string(size) + " bytes");
}

/// Removes a file; tries again, because files cannot be removed while a client that follows the log
/// reads them.
void remove_unless_read(RemoteLog& log, const NamedChild& file)
{
    constexpr int most_attempts = 50;
    constexpr std::chrono::milliseconds pause{100};
    for (int attempt = 1;; ++attempt) {
        try {
            return log.remove(file);
        } catch (const Failure& failure) {
            if (failure.status != status::Bad_InvalidState || attempt == most_attempts) {
                throw;
            }
        }
        std::this_thread::sleep_for(pause);
    }
}

Exit clear(Context& context, Connection& connection, RemoteLog& log,
           const AdminArguments& arguments)
{
    make_sure(context, arguments,
              "remove all " + std::to_string(log.files().size()) + " files of the execution log?");
    const std::vector<NamedChild> files = log.complete_files();
    // Clients that follow the log read the last records of the file that is complete now.
    if (!connection.blocking().run_for(2 * follow_period)) {
        throw Interrupted{};
    }
    std::size_t removed = 0;
    for (const NamedChild& file : files) {
        remove_unless_read(log, file);
        ++removed;
    }
    return report(context, "cleared the execution log: " + std::to_string(removed) + " files");
}

Exit run(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteLog log{connection};
    if (arguments.log.is_cleared) {
        return clear(context, connection, log, arguments);
    }
    if (!arguments.log.folder.empty()) {
        return save(context, log, arguments);
    }
    return arguments.log.is_followed ? follow(context, connection, log, arguments)
                                     : show(context, log, arguments.log);
}

} // namespace
} // namespace log

void add_log(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    LogChoice& choice = group.arguments().log;
    auto* command =
        group.add("log", "Shows the execution log of a controller.", 0, "URL", log::run);
    command->add_option("--category", choice.category, "only SERVER, AUTH or CERT")
        ->transform(CLI::IsMember({"SERVER", "AUTH", "CERT"}, CLI::ignore_case))
        ->type_name("CATEGORY");
    command->add_option("--code", choice.code, "only this log code")->type_name("CODE");
    command->add_option("--text", choice.text, "only with this in the log name or the details")
        ->type_name("TEXT");
    command->add_option("-n,--count", choice.count, "the last N, 100 if it is not given")
        ->check(CLI::Range(std::size_t{1}, log::most_entries))
        ->type_name("N");
    auto* follows =
        command->add_flag("--follow", choice.is_followed, "go on with what is new, until Ctrl+C");
    command->add_option("--duration", group.arguments().end.seconds, "end --follow after so long")
        ->needs(follows)
        ->type_name("SECONDS");
    auto* saves = command->add_option("--save", choice.folder, "copy its files into a folder")
                      ->excludes(follows)
                      ->type_name("FOLDER");
    command->add_flag("--clear", choice.is_cleared, "remove its files from the controller")
        ->excludes(follows)
        ->excludes(saves);
    command->add_flag("--yes", group.arguments().is_sure, "ask nothing");
}

} // namespace busbar::tool::admin
