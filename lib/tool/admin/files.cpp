#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "remote_files.hpp"
#include "tool/printing/display_text.hpp"
#include "tool/printing/file.hpp"
#include "tool/printing/json_writer.hpp"
#include "tool/printing/table.hpp"

namespace busbar::tool::admin {

namespace files {
namespace {

/// Maximum size of a file to transfer.
constexpr std::size_t max_transfer = 256U << 20U;

constexpr std::uint8_t open_to_replace = 6;

/// A file or folder by its path for people: "recipes/press/4.csv".
struct Place {
    std::string path;
    NodeId node;

    [[nodiscard]] std::string name() const { return path.substr(path.rfind('/') + 1); }
    [[nodiscard]] std::string folder() const
    {
        const std::size_t end = path.rfind('/');
        return end == std::string::npos ? std::string{} : path.substr(0, end);
    }
};

Place find_place(Connection& connection, const std::string& path)
{
    NodeId node = look_for_file(connection, path);
    if (path.empty() || node.is_null()) {
        throw Failure{status::Bad_NotFound, safe(path), "see `busbar admin file list`"};
    }
    return {path, std::move(node)};
}

std::vector<Variant> on(Connection& connection, const Place& place, const char* method,
                        const std::vector<Variant>& inputs)
{
    return call_on_file(connection, place.node, place.path, method, inputs);
}

/// The folder in which a new file or folder is created.
Place folder_of(Connection& connection, const std::string& path)
{
    const Place place{path, {}};
    if (place.folder().empty()) {
        throw Failure{Exit::Usage, safe(path) + ": names no file in a folder",
                      "such as recipes/press.csv; see `busbar admin file list`"};
    }
    return find_place(connection, place.folder());
}

Exit list(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string path = arguments.words.empty() ? std::string{} : arguments.words.front();
    const NodeId parent = path.empty() ? file_root(connection) : find_place(connection, path).node;
    JsonLine json;
    json.open_array();
    Table table{{{"NAME", 16, false, true}, {"BYTES"}, {"CHANGED", 19}}};
    for (const NamedChild& child : objects_below(connection, parent)) {
        const bool is_folder = !find_method(connection, child.id, "CreateDirectory").is_null();
        const Variant size = is_folder ? Variant{} : file_property(connection, child.id, "Size");
        if (!is_folder && size.is_null()) {
            continue; // no file
        }
        const DateTime changed =
            file_property(connection, child.id, "LastModifiedTime").value_or<DateTime>({});
        const std::string bytes =
            is_folder ? std::string{} : std::to_string(size.value_or<std::uint64_t>(0));
        json.open_object().member("name", child.name).member("isFolder", is_folder);
        if (!is_folder) {
            json.member("size", bytes).member("changed", changed);
        }
        json.close_object();
        table.add({{safe(child.name) + (is_folder ? "/" : "")},
                   {bytes},
                   {is_folder ? "" : to_string(changed).substr(0, 19)}});
    }
    return print_rows(context, json.close_array(), table, "No files");
}

Exit get(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const Place place = find_place(connection, arguments.words[0]);
    const std::string& local = arguments.words[1];
    if (std::error_code ignored; std::filesystem::exists(local, ignored)) {
        make_sure(context, arguments, "replace " + local + "?");
    }
    const auto all = static_cast<std::size_t>(
        file_property(connection, place.node, "Size").value_or<std::uint64_t>(0));
    const auto progress = [&](std::size_t done) { show_progress(context, done, all); };
    const std::string text = download(connection, place.node, place.path,
                                      {.max_size = max_transfer, .progress = progress});
    write_file(local, text);
    return report(context,
                  "got " + safe(place.path) + ": " + std::to_string(text.size()) + " bytes");
}

/// The file to write to, which is created if it does not exist.
Place place_to_write(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& path = arguments.words[1];
    NodeId node = look_for_file(connection, path);
    if (!node.is_null()) {
        make_sure(context, arguments, "replace " + safe(path) + " of the server?");
        return {path, std::move(node)};
    }
    const auto made = on(connection, folder_of(connection, path), "CreateFile",
                         {Variant{String{Place{path, {}}.name()}}, Variant{false}});
    return {path, made.empty() ? NodeId{} : made.front().value_or<NodeId>({})};
}

Exit put(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string text = read_file(arguments.words[0], max_transfer);
    const Place place = place_to_write(context, connection, arguments);
    const auto opened = on(connection, place, "Open", {Variant{open_to_replace}});
    const Variant handle = opened.empty() ? Variant{} : opened.front();
    const auto bytes = std::as_bytes(std::span{text});
    const std::size_t most = piece_to_write(connection, place.node);
    for (std::size_t done = 0; done < bytes.size();) {
        const auto piece = bytes.subspan(done, std::min(most, bytes.size() - done));
        on(connection, place, "Write", {handle, Variant{ByteString{piece}}});
        done += piece.size();
        show_progress(context, done, bytes.size());
    }
    on(connection, place, "Close", {handle});
    return report(context,
                  "put " + safe(place.path) + ": " + std::to_string(bytes.size()) + " bytes");
}

Exit make_folder(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const std::string& path = arguments.words[0];
    on(connection, folder_of(connection, path), "CreateDirectory",
       {Variant{String{Place{path, {}}.name()}}});
    return report(context, "made " + safe(path));
}

Exit move(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const Place from = find_place(connection, arguments.words[0]);
    const std::string& path = arguments.words[1];
    const Place target = folder_of(connection, path);
    on(connection, folder_of(connection, from.path), "MoveOrCopy",
       {Variant{from.node}, Variant{target.node}, Variant{false},
        Variant{String{Place{path, {}}.name()}}});
    return report(context, safe(from.path) + " is " + safe(path) + " now");
}

Exit remove(Context& context, Connection& connection, const AdminArguments& arguments)
{
    const Place place = find_place(connection, arguments.words[0]);
    const Place folder = folder_of(connection, place.path);
    make_sure(context, arguments, "remove " + safe(place.path) + " and what is in it?");
    on(connection, folder, "Delete", {Variant{place.node}});
    return report(context, "removed " + safe(place.path));
}

} // namespace
} // namespace files

void add_files(CLI::App& admin, Run& run)
{
    using namespace files;
    Group group{admin, run, "file", "Files that the server shares."};
    const auto asks = [&](CLI::App* command) {
        command->add_flag("--yes", group.arguments().is_sure, "ask nothing");
    };
    group.add_any("list", "Lists the folders, or what is in one.", "URL FOLDER", list);
    asks(group.add("get", "Copies a file from the server.", 2, "FILE LOCAL", get));
    asks(group.add("put", "Copies a file to the server, as a whole or not at all.", 2, "LOCAL FILE",
                   put));
    group.add("mkdir", "Makes a folder.", 1, "FOLDER", make_folder);
    group.add("move", "Moves or renames a file or a folder.", 2, "FROM TO", files::move);
    asks(group.add("remove", "Removes a file, or a folder with all in it.", 1, "FILE",
                   files::remove));
}

} // namespace busbar::tool::admin
