#include <string>
#include <vector>

#include "commands.hpp"
#include "tool/admin/commands.hpp"
#include "tool/admin/remote_files.hpp"
#include "tool/admin/remote_transfer.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::project {

namespace {

using admin::items_in;
using admin::Json;
using admin::RemoteTransfer;
using admin::text_in;
using RemoteArguments = admin::AdminArguments;

RemoteTransfer transfer_of(Connection& connection)
{
    return {connection, "Project",
            "the server has no project, which --project gives it, or this user may not see it: "
            "log in as one with the role SecurityAdmin or ConfigureAdmin"};
}

/// Sends the file to the server; reports the server's reason for a refusal, which the status does
/// not tell.
void send(Context& context, RemoteTransfer& transfer, const char* what, const std::string& file)
{
    try {
        transfer.send(Variant{what}, file,
                      [&](std::size_t done) { admin::show_progress(context, done, file.size()); });
    } catch (const Failure& failure) {
        if (transfer.may_be_taken(failure)) {
            throw Failure{failure.status,
                          std::string{what} + ": the server did not answer after all was sent, and "
                                              "whether it was done is not known",
                          "`busbar project status` tells what the server has, and `busbar project "
                          "verify` whether it is this project; --timeout SECONDS waits longer"};
        }
        std::string reason = failure.reason;
        if (reason.empty()) {
            try {
                reason = text_in(transfer.answer("report"), "problem");
            } catch (const Failure&) {
                // The server refused it before it looked at the file: the status says why.
            }
        }
        throw Failure{failure.status,
                      std::string{what} + ": nothing was changed" +
                          (reason.empty() ? "" : ": " + safe(reason)),
                      failure.hint};
    }
}

/// The file, which is a project.
std::string document_in(const std::string& path)
{
    static_cast<void>(open_project(path));
    return read_file(path, controller::ProjectLimits{}.max_file_size);
}

/// Throws Failure for a project that a server could not serve (SH-082679, 8.3).
void refuse_errors(Context& context, const std::string& path)
{
    const auto check = check_project_models(open_project(path));
    if (check.reports.has_errors()) {
        print_reports(context, check.reports);
        throw Failure{Exit::Failed,
                      std::to_string(check.reports.error_count()) + " errors: nothing was written",
                      "`busbar project check` lists them, too"};
    }
}

Exit write(Context& context, Connection& connection, const RemoteArguments& arguments)
{
    const std::string document = document_in(arguments.words[0]);
    refuse_errors(context, arguments.words[0]);
    RemoteTransfer transfer = transfer_of(connection);
    admin::make_sure(context, arguments, "Replace the project of the server?");
    send(context, transfer, "write", document);
    return admin::report(context,
                         "written; it takes effect after `busbar project update` or a restart");
}

Exit read(Context& context, Connection& connection, const RemoteArguments& arguments)
{
    const std::string& path = arguments.words[0];
    RemoteTransfer transfer = transfer_of(connection);
    make_room(context, path, arguments.is_sure);
    const std::string document = transfer.fetch(Variant{});
    if (const auto project = controller::read_project(document, "the server's"); !project) {
        throw Failure{Exit::Failed, text(project.error()), "nothing was written"};
    }
    save_file(path, document);
    return admin::report(context,
                         "read to " + path + ": " + std::to_string(document.size()) + " bytes");
}

Exit verify(Context& context, Connection& connection, const RemoteArguments& arguments)
{
    const std::string document = document_in(arguments.words[0]);
    RemoteTransfer transfer = transfer_of(connection);
    send(context, transfer, "verify", document);
    const Json report = transfer.answer("report");
    std::vector<controller::ProjectDifference> differences;
    for (const Json& each : items_in(report, "differences")) {
        differences.push_back(
            {text_in(each, "where"), text_in(each, "file"), text_in(each, "server")});
    }
    return print_differences(context, differences, "FILE", "SERVER");
}

/// Lets the server compare the labels of the written project with its PLC.
Json label_report(Context& context, RemoteTransfer& transfer)
{
    send(context, transfer, "labels", {});
    return transfer.answer("report");
}

/// Lists the labels that the PLC has not, or has of another type than their nodes.
Exit list_labels(Context& context, Connection& connection, const RemoteArguments&)
{
    RemoteTransfer transfer = transfer_of(connection);
    const Json report = label_report(context, transfer);
    Table table{{{"NODE", 12}, {"PART"}, {"LABEL", 12}, {"EXPECTED", 16}, {"FOUND", 12}, {"USE"}}};
    JsonLine json;
    json.open_object().key("labels").open_array();
    bool is_refused = false;
    for (const Json& each : items_in(report, "labels")) {
        std::vector<Cell> cells;
        json.open_object();
        for (const char* const name : {"node", "part", "label", "expected", "found", "use"}) {
            const std::string text = text_in(each, name);
            json.member(name, text);
            cells.push_back({safe(text)});
        }
        json.close_object();
        is_refused = is_refused || text_in(each, "use") == "refused";
        table.add(std::move(cells));
    }
    const std::string count = text_in(report, "labelCount");
    if (context.options.is_json) {
        json.close_array().member("labelCount", count);
        context.out.line(json.close_object().document());
    } else if (table.row_count() == 0) {
        context.out.line("no differences");
    } else {
        table.print(context.out);
        context.out.line(safe(count) + " labels differ");
    }
    return is_refused ? Exit::Failed : Exit::Good;
}

/// Makes the running server use the written project, as a restart does.
Exit update(Context& context, Connection& connection, const RemoteArguments& arguments)
{
    RemoteTransfer transfer = transfer_of(connection);
    admin::make_sure(context, arguments, "Have the server take up the project that was written?");
    const std::string converted = text_in(label_report(context, transfer), "labelCount");
    try {
        send(context, transfer, arguments.despite_labels ? "update despite labels" : "update", {});
    } catch (Failure& failure) {
        if (std::string_view{failure.what()}.find("labels cannot be used") != std::string::npos) {
            failure.hint = "`busbar project labels` lists them all; --despite-labels has the "
                           "project count before the PLC has its program";
        }
        throw;
    }
    const bool has_differences = !converted.empty() && converted != "0";
    return admin::report(context,
                         "the server takes up its project" +
                             (has_differences ? "; `busbar project labels` lists " + converted +
                                                    " labels of another type than their nodes"
                                              : std::string{}));
}

Exit restart(Context& context, Connection& connection, const RemoteArguments& arguments)
{
    RemoteArguments again = arguments;
    again.restarts = true;
    return admin::shut_down(context, connection, again);
}

Exit show_status(Context& context, Connection& connection, const RemoteArguments&)
{
    RemoteTransfer transfer = transfer_of(connection);
    const Json status = transfer.answer("status");
    JsonLine json;
    json.open_object();
    Table table{{{"ITEM", 16}, {"STATE", 16}}};
    for (std::size_t i = 0; i < status.items.size() && i < status.names.size(); ++i) {
        json.member(status.names[i], status.items[i].text);
        table.add({{safe(status.names[i])}, {safe(status.items[i].text)}});
    }
    return print_rows(context, json.close_object(), table);
}

} // namespace

void add_online(CLI::App& project, Run& run)
{
    admin::Group group{project, run, nullptr, ""};
    RemoteArguments& arguments = group.arguments();
    const auto asks = [&](CLI::App* command) {
        command->add_flag("--yes", arguments.is_sure, "ask nothing");
    };
    asks(
        group.add("write", "Writes a project to a server, whole or not at all.", 1, "FILE", write));
    asks(group.add("read", "Reads the project of a server.", 1, "FILE", read));
    group.add("labels", "Lists labels of the written project that differ from those of the PLC.", 0,
              "URL", list_labels);
    group.add("verify", "Lists what differs between a project and that of a server.", 1, "FILE",
              verify);
    CLI::App* const updates =
        group.add("update", "Has a server take up the project that was written.", 0, "URL", update);
    asks(updates);
    updates->add_flag("--despite-labels", arguments.despite_labels,
                      "also if labels of it cannot be used with the program of the PLC");
    for (CLI::App* command :
         {group.add("stop", "Stops a server.", 0, "URL", admin::shut_down),
          group.add("restart", "Restarts a server, with its project.", 0, "URL", restart)}) {
        asks(command);
        command->add_option("--seconds", arguments.seconds, "how long clients are told before")
            ->check(CLI::Range(0U, 86'400U));
        command->add_option("--reason", arguments.reason, "what clients are told");
    }
    group.add("status", "Shows the state of a server and its project.", 0, "URL", show_status);
}

} // namespace busbar::tool::project
