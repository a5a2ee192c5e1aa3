#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <busbar/storage/folder_storage.hpp>

#include "commands.hpp"
#include "remote_files.hpp"
#include "remote_transfer.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

namespace backup {
namespace {

/// Greater than any backup.
constexpr std::size_t max_backup = 256U << 20U;
constexpr std::size_t max_command = 65'536;
/// The variable by which the program of the controller decides (W588, A-4).
constexpr std::string_view restore_target = "_Card1RestoreCmdTargetOpcuaSPF";
constexpr const char* restart_is_due =
    "it takes effect after a restart of the controller, which is due in a few seconds";
constexpr const char* trusts_nobody =
    ".\nThen it has a new certificate and trusts no client: with `setup = true` in its [users], "
    "`busbar admin setup` makes the first account by the code that it shows; otherwise the "
    "certificate of this user has to be trusted at the controller again";

RemoteTransfer transfer_of(Connection& connection)
{
    return {connection, "Backup",
            "the server has no backups, which [machine] gives it, or this user may not see them: "
            "log in as one with the role SecurityAdmin"};
}

/// Describes the result of a restore. The server stops after it (W588, 4-1-3), so the report may be
/// missing.
std::string restored_text(RemoteTransfer& transfer)
{
    const auto is_no = [](const Json& report, std::string_view name) {
        const Json* const found = report.find(name);
        return found != nullptr && found->kind == Json::Kind::False;
    };
    try {
        const Json report = transfer.answer("report");
        if (is_no(report, "restored")) {
            return "cleared, since the file is of a controller without OPC UA server; ";
        }
        const Json* const variable = report.find(restore_target);
        if (variable != nullptr && variable->kind == Json::Kind::False) {
            return "restored; " + std::string{restore_target} +
                   " is FALSE: certificates, users, roles and security settings stay; ";
        }
        if (is_no(report, "security_profile")) {
            return "restored; the file has no security profile: certificates, users, roles and "
                   "security settings stay; ";
        }
    } catch (const Failure&) {
    }
    return "restored; ";
}

/// Fails with the reason, which the status alone does not tell.
[[noreturn]] void fail_with_report(RemoteTransfer& transfer, const Failure& failure,
                                   const std::string& what)
{
    if (!failure.reason.empty()) {
        Failure told{failure.status, what + ": nothing was changed"};
        told.reason = failure.reason;
        told.hint.clear();
        throw Failure{told};
    }
    std::string reason;
    try {
        const Json report = transfer.answer("report");
        const Json* const problem = report.find("problem");
        reason = problem != nullptr ? ": " + safe(problem->text) : "";
    } catch (const Failure&) {
        // Refused before the file was looked at: explain the status.
    }
    if (failure.status == status::Bad_InvalidState) {
        throw Failure{failure.status, what + ": nothing was changed" + reason,
                      "a restart of the controller is due, or it is in RUN mode, where its memory "
                      "is not cleared"};
    }
    throw Failure{failure.status, what + ": nothing was changed" + reason,
                  failure.hint.empty() ? "see the log of the controller" : failure.hint};
}

void send(Context& context, RemoteTransfer& transfer, const std::string& options,
          const std::string& file, const std::string& what)
{
    try {
        transfer.send(Variant{String{options}}, file,
                      [&](std::size_t done) { show_progress(context, done, file.size()); });
    } catch (const Failure& failure) {
        if (transfer.may_be_taken(failure)) {
            throw Failure{failure.status,
                          what + ": the server did not answer after all was sent, and whether it "
                                 "was done is not known",
                          "`busbar admin status` tells whether a restart is due"};
        }
        fail_with_report(transfer, failure, what);
    }
}

std::string options_of(const AdminArguments& arguments, const std::string& verb)
{
    return verb + (arguments.backup.without_security ? " without security profile" : "");
}

/// Writes the file as a whole or not at all, and readable for its owner only: it contains hashes of
/// passwords.
void keep(const std::string& path, const std::string& file)
{
    const auto place = std::filesystem::path{path};
    const std::string folder = place.parent_path().empty() ? "." : place.parent_path().string();
    storage::FolderStorage files{folder};
    const auto kept =
        files.replace(place.filename().string(), std::as_bytes(std::span{file}), FileAccess::Owner);
    if (!kept) {
        throw Failure{Exit::Failed, path + ": " + std::string{text(kept.error())},
                      "nothing was written"};
    }
}

Exit back_up(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    const std::string& local = arguments.words[0];
    if (std::error_code ignored; std::filesystem::exists(local, ignored)) {
        make_sure(context, arguments, "replace " + local + "?");
    }
    const bool is_whole = !arguments.backup.without_security;
    const std::string file =
        transfer.fetch(is_whole ? Variant{} : Variant{String{options_of(arguments, "backup")}});
    keep(local, file);
    return report(context, "backed up to " + local + ": " + std::to_string(file.size()) + " bytes");
}

Exit restore(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& local = arguments.words[0];
    const std::string file = read_file(local, max_backup);
    RemoteTransfer transfer = transfer_of(connection);
    make_sure(context, arguments,
              arguments.backup.without_security
                  ? "Replace the program and the settings of the controller?"
                  : "Replace the program, settings, certificates, users and roles of the "
                    "controller?");
    const std::string& command = arguments.backup.command_file;
    send(context, transfer,
         arguments.backup.is_by_variable ? std::string{"restore by variable"}
         : command.empty()               ? options_of(arguments, "restore")
                                         : "restore by command\n" + read_file(command, max_command),
         file, local);
    return report(context, restored_text(transfer) + restart_is_due);
}

/// Prints the differences; true if there are none.
bool print_verification(Context& context, const Json& report)
{
    bool is_same = true;
    JsonLine json;
    json.open_object().key("items").open_array();
    Table table{{{"DATA", 16}, {"DIFFERENCE", 16, false, true}}};
    for (const Json& item : items_in(report, "items")) {
        std::string all;
        std::vector<std::string> differences;
        for (const Json& file : items_in(item, "differences")) {
            differences.push_back(file.text);
            all += (all.empty() ? "" : ", ") + safe(file.text);
        }
        is_same = is_same && differences.empty();
        const std::string shown = text_in(item, "name");
        json.open_object().member("name", shown).key("differences").texts(differences);
        json.close_object();
        table.add(
            {{safe(shown)}, {all.empty() ? "none" : all, all.empty() ? Style::Plain : Style::Bad}});
    }
    json.close_array().member("isSame", is_same).close_object();
    print_rows(context, json, table);
    return is_same;
}

Exit verify(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& local = arguments.words[0];
    const std::string file = read_file(local, max_backup);
    RemoteTransfer transfer = transfer_of(connection);
    send(context, transfer, options_of(arguments, "verify"), file, local);
    return print_verification(context, transfer.answer("report")) ? Exit::Good : Exit::Failed;
}

Exit clear(Context& context, Connection& connection, const AdminArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    const bool clears_security = arguments.backup.clears_security;
    make_sure(context, arguments,
              clears_security
                  ? "Clear the settings, users, roles and all certificates, the server's too?"
                  : "Clear the settings of the server, and the program that was sent to it?");
    send(context, transfer, clears_security ? "clear with security" : "clear", {},
         "clear all memory");
    return report(context, "all memory was cleared; " + std::string{restart_is_due} +
                               (clears_security ? trusts_nobody : ""));
}

} // namespace
} // namespace backup

void add_backup(CLI::App& admin, Run& run)
{
    Group group{admin, run, nullptr, ""};
    AdminArguments& arguments = group.arguments();
    const auto asks = [&](CLI::App* command) {
        command->add_flag("--yes", arguments.is_sure, "ask nothing");
        return command;
    };
    const auto chooses = [&](CLI::App* command) {
        command->add_flag("--without-security-profile", arguments.backup.without_security,
                          "leave certificates, users, roles and security settings out");
        return command;
    };
    chooses(
        asks(group.add("backup",
                       "Saves a controller's program, settings, values, certificates, users, roles "
                       "and events.",
                       1, "FILE", backup::back_up)));
    auto* restore = chooses(asks(
        group.add("restore", "Replaces what a controller has by a backup, whole or not at all.", 1,
                  "FILE", backup::restore)));
    auto* command =
        restore
            ->add_option("--command", arguments.backup.command_file,
                         "a RestoreCommand.ini; its OpcuaSPF says whether certificates, users, "
                         "roles and security settings are restored")
            ->excludes("--without-security-profile");
    restore
        ->add_flag("--by-variable", arguments.backup.is_by_variable,
                   "_Card1RestoreCmdTargetOpcuaSPF of the controller's program says it")
        ->excludes("--without-security-profile")
        ->excludes(command);
    chooses(group.add("verify", "Compares what a controller has with a backup.", 1, "FILE",
                      backup::verify));
    asks(group.add("clear", "Clears a controller's memory, in PROGRAM mode.", 0, "URL",
                   backup::clear))
        ->add_flag("--security", arguments.backup.clears_security,
                   "users, roles, security settings and all certificates, too");
}

} // namespace busbar::tool::admin
