#include "sections.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/program_files.hpp>

#include "product/machine/program_file.hpp"

namespace busbar::product {

namespace {

constexpr std::int64_t most_file_size = 1U << 30U;
constexpr std::int64_t most_entries_of_files = 100'000;
constexpr std::size_t most_folders = 16;

/// Returns the places of a file or folder: where it is, and, if that is another place, where a link
/// that leads to it is.
std::array<std::filesystem::path, 2> places(const std::string& path)
{
    const auto whole = [](const std::filesystem::path& made) {
        return made.has_filename() ? made : made.parent_path();
    };
    std::error_code ignored;
    // Make it absolute first: for a relative path that does not exist, weakly_canonical would
    // leave the working directory out. What ".." leads out of may be a link.
    const auto absolute = std::filesystem::absolute(path);
    const auto normal = absolute.lexically_normal();
    const auto real = std::filesystem::weakly_canonical(absolute, ignored);
    // The link's own folder may be a link, too.
    const auto folder = std::filesystem::weakly_canonical(whole(normal).parent_path(), ignored);
    return {whole(real.empty() ? normal : real), folder / whole(normal).filename()};
}

/// True if one of the folders is or contains the other.
bool overlap(const std::string& a, const std::string& b)
{
    const auto is_within = [](const std::filesystem::path& first,
                              const std::filesystem::path& second) {
        const auto [left, right] =
            std::mismatch(first.begin(), first.end(), second.begin(), second.end());
        return left == first.end() || right == second.end();
    };
    const auto of_a = places(a);
    const auto of_b = places(b);
    return std::any_of(of_a.begin(), of_a.end(), [&](const auto& first) {
        return std::any_of(of_b.begin(), of_b.end(),
                           [&](const auto& second) { return is_within(first, second); });
    });
}

FilesConfig read_folder(const TomlTable& entry, const CertificateConfig& certificates)
{
    entry.allow({"name", "folder", "readers", "writers", "file_size", "entries"});
    FilesConfig files;
    files.name = entry.text("name");
    const bool is_name = !files.name.empty() && files.name.size() <= 63 &&
                         std::all_of(files.name.begin(), files.name.end(), [](char each) {
                             return (each >= 'a' && each <= 'z') || (each >= 'A' && each <= 'Z') ||
                                    (each >= '0' && each <= '9') || each == '_' || each == '-';
                         });
    if (!is_name) {
        entry.fail("name", "1 to 63 letters, digits, - or _");
    }
    files.folder = entry.text("folder");
    if (files.folder.empty()) {
        entry.fail("folder", "a folder");
    }
    if (overlap(files.folder, certificates.folder)) {
        entry.refuse("folder", "found \"" + files.folder + "\", expected one apart from \"" +
                                   certificates.folder + "\", which has keys in it");
    }
    files.readers = read_roles(entry, "readers", {"Operator", "Engineer", "Supervisor"});
    files.writers = read_roles(entry, "writers", {"ConfigureAdmin"});
    files.limits.max_file_size = static_cast<std::size_t>(entry.integer(
        "file_size", static_cast<std::int64_t>(files.limits.max_file_size), 1, most_file_size));
    files.limits.max_written = std::max(files.limits.max_written, 2 * files.limits.max_file_size);
    files.limits.max_entries = static_cast<std::size_t>(entry.integer(
        "entries", static_cast<std::int64_t>(files.limits.max_entries), 1, most_entries_of_files));
    return files;
}

/// A file or folder that is not for clients.
struct Own {
    std::string path;
    const char* use;
};

/// Adds the files of a program. Those of a list of files are anywhere in its folder.
void add_program(std::vector<Own>& all, const std::string& program_file, const char* use)
{
    for (const std::string& each : paths_of(program_file)) {
        const std::filesystem::path path{each};
        const std::filesystem::path folder =
            path.has_parent_path() ? path.parent_path() : std::filesystem::path{"."};
        all.push_back({controller::is_program_list(each) ? folder.string() : each, use});
    }
}

/// Adds the file that a key names, if it is there.
void add_named(std::vector<Own>& all, const TomlTable& table, const char* key, const char* use)
{
    if (std::string path = table.text(key, ""); !path.empty()) {
        all.push_back({std::move(path), use});
    }
}

std::vector<Own> own_files(const TomlTable& root, const ControllerConfig& config)
{
    std::vector<Own> all{{root.file(), "the configuration"}};
    if (const MachineConfig& machine = config.machine; !machine.program_file.empty()) {
        constexpr const char* of_machine = "where the machine keeps its own files";
        const std::filesystem::path log = controller::ExecutionLogOptions{}.folder;
        add_program(all, machine.program_file, "the machine's program");
        all.push_back({machine.state_folder, of_machine});
        all.push_back(
            {std::filesystem::path{machine.medium_folder} / log.parent_path(), of_machine});
    }
    add_program(all, config.labels.program_file, "the program of the labels");
    constexpr const char* password_key = "remote_password_file";
    constexpr const char* of_plc = "the password of a PLC";
    add_named(all, root.table("labels"), password_key, of_plc);
    for (const TomlTable& entry : root.tables("backend")) {
        add_named(all, entry, password_key, of_plc);
        add_named(all, entry, "table", "the addresses of a PLC");
    }
    for (const std::string& each : config.nodesets) {
        all.push_back({each, "an information model"});
    }
    add_named(all, root.table("server"), "key_log", "the log of keys");
    add_named(all, root.table("users").table("tokens"), "key_file", "the key of users' tokens");
    return all;
}

} // namespace

std::vector<FilesConfig> read_files(const TomlTable& root, const CertificateConfig& certificates)
{
    std::vector<FilesConfig> all;
    for (const TomlTable& entry : root.tables("files")) {
        FilesConfig files = read_folder(entry, certificates);
        for (const FilesConfig& other : all) {
            if (other.name == files.name) {
                entry.refuse("name", "found \"" + files.name + "\" again, expected another");
            }
            if (overlap(files.folder, other.folder)) {
                entry.refuse("folder", "found \"" + files.folder +
                                           "\", expected one apart from \"" + other.folder +
                                           "\" of " + other.name);
            }
        }
        if (all.size() == most_folders) {
            entry.fail("name", "no more than 16 folders");
        }
        all.push_back(std::move(files));
    }
    return all;
}

void check_files(const TomlTable& root, const ControllerConfig& config)
{
    const std::vector<Own> all = own_files(root, config);
    const std::vector<TomlTable> entries = root.tables("files");
    for (std::size_t i = 0; i < entries.size(); ++i) {
        for (const auto& [path, use] : all) {
            if (overlap(config.files[i].folder, path)) {
                entries[i].refuse("folder", "found \"" + config.files[i].folder +
                                                "\", expected one apart from \"" + path + "\", " +
                                                use);
            }
        }
    }
}

} // namespace busbar::product
