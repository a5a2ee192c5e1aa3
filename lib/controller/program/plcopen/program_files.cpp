#include <busbar/controller/program_files.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <pugixml.hpp>

#include <busbar/core/text.hpp>

#include "core/ascii_case.hpp"
#include "foreign_format.hpp"
#include "plcopen_reader.hpp"
#include "program_bundle.hpp"

namespace busbar::controller {

namespace {

namespace fs = std::filesystem;
using busbar::detail::is_same_ignoring_case;
using busbar::detail::to_ascii_lower;
using detail::BundleEntry;

constexpr std::size_t max_depth = 32;
/// Entries of folders, so that a tree of other files ends the search as well.
constexpr std::size_t max_visited = 200'000;

/// The endings of files that programs are in.
constexpr std::array<std::string_view, 21> program_endings{
    ".st",   ".iecst", ".scl", ".udt", ".db",      ".exp",   ".var",
    ".typ",  ".gvl",   ".dut", ".xml", ".tcgvl",   ".tcdut", ".tcpou",
    ".tcio", ".csv",   ".txt", ".fun", ".plcopen", ".awl",   ".iec",
};
/// The objects of TwinCAT that have declarations.
constexpr std::array<std::string_view, 4> twincat_endings{".tcgvl", ".tcdut", ".tcpou", ".tcio"};
constexpr std::string_view list_ending = ".plcproj";
/// A larger .plcproj is not parsed, because that takes many times its size.
constexpr std::size_t max_list_size = 4U << 20U;

std::string lower(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(),
                   [](char c) { return to_ascii_lower(c); });
    return text;
}

template <std::size_t n>
bool has_ending(const fs::path& path, const std::array<std::string_view, n>& endings)
{
    const std::string ending = lower(path.extension().string());
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

bool is_list(const fs::path& path)
{
    return is_same_ignoring_case(path.extension().string(), list_ending);
}

/// Tells whether the file lists those of a program, whatever its name is.
bool is_list(const fs::path& path, std::string_view text)
{
    return is_list(path) ||
           (detail::xml_root(text) == "Project" && text.find("<ItemGroup") != text.npos);
}

/// Reads a file of at most `most` bytes.
Configured<std::string> text_of(const fs::path& path, std::size_t most)
{
    std::error_code ignored;
    if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) {
        return misconfigured(path.string(), "found no regular file, expected a file");
    }
    errno = 0;
    std::ifstream file{path, std::ios::binary};
    std::string text;
    while (file && text.size() <= most) {
        constexpr std::size_t piece = 64U << 10U;
        const std::size_t before = text.size();
        text.resize(before + piece);
        file.read(text.data() + before, static_cast<std::streamsize>(piece));
        text.resize(before + static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad() || !file.is_open()) {
        return misconfigured(path.string(),
                             "the file cannot be read: " + std::generic_category().message(errno),
                             status::Bad_NotFound);
    }
    if (text.size() > most) {
        return misconfigured(path.string(), "found more than " + std::to_string(most) + " bytes",
                             status::Bad_EncodingLimitsExceeded);
    }
    return text;
}

/// Finds files by names in which case and separators are those of Windows.
class CaselessFolder {
public:
    explicit CaselessFolder(fs::path folder) : folder_{std::move(folder)} {}

    /// Returns the path of a file below the folder; the path as it stands if there is none.
    fs::path find(const fs::path& relative)
    {
        fs::path path = folder_;
        for (const fs::path& step : relative) {
            std::error_code ignored;
            if (fs::exists(path / step, ignored)) {
                path /= step;
                continue;
            }
            const auto& names = names_in(path);
            const auto found = names.find(lower(step.string()));
            if (found == names.end()) {
                return folder_ / relative;
            }
            path /= found->second;
        }
        return path;
    }

private:
    const std::map<std::string, std::string>& names_in(const fs::path& folder)
    {
        const auto [found, is_new] = names_.try_emplace(folder.string());
        std::error_code error;
        fs::directory_iterator entry{folder, error};
        std::size_t count = 0;
        for (; is_new && !error && entry != fs::directory_iterator{} && count < max_visited;
             entry.increment(error)) {
            const std::string name = entry->path().filename().string();
            found->second.emplace(lower(name), name);
            ++count;
        }
        return found->second;
    }

    fs::path folder_;
    std::map<std::string, std::map<std::string, std::string>> names_{};
};

/// Replaces the %xx with which MSBuild writes special characters.
std::string without_escapes(std::string_view text)
{
    constexpr std::string_view digits = "0123456789abcdef";
    std::string all;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto digit = [&](std::size_t at) {
            return at < text.size() ? digits.find(to_ascii_lower(text[at])) : digits.npos;
        };
        const bool is_escape =
            text[i] == '%' && digit(i + 1) != digits.npos && digit(i + 2) != digits.npos;
        all += is_escape ? static_cast<char>(digit(i + 1) * 16 + digit(i + 2)) : text[i];
        i += is_escape ? 2 : 0;
    }
    return all;
}

/// Lists the files with declarations that a .plcproj compiles, as it names them; without tasks,
/// visualizations and others.
std::vector<fs::path> compiled_files(const pugi::xml_document& document)
{
    std::vector<fs::path> all;
    for (const pugi::xml_node& group : document.document_element().children("ItemGroup")) {
        for (const pugi::xml_node& item : group.children("Compile")) {
            std::string words = without_escapes(item.attribute("Include").value());
            std::replace(words.begin(), words.end(), '\\', '/');
            fs::path path{words};
            const bool is_excluded =
                is_same_ignoring_case(item.child("ExcludeFromBuild").text().get(), "true");
            if (!is_excluded && has_ending(path, twincat_endings)) {
                all.push_back(std::move(path));
            }
        }
    }
    return all;
}

/// Collects the files of a program.
class FileCollector {
public:
    explicit FileCollector(std::size_t max_size) : max_size_{max_size} {}

    Configured<void> add(const fs::path& path)
    {
        std::error_code ignored;
        if (fs::is_directory(path, ignored)) {
            return add_folder(path);
        }
        return text_of(path, max_size_).and_then([&](const std::string& text) -> Configured<void> {
            return is_list(path, text) ? add_list(path, text)
                                       : add_text(path, path.filename(), text);
        });
    }

    std::string take() { return bundle_.take(); }

private:
    Configured<void> add_folder(const fs::path& folder)
    {
        std::vector<fs::path> files;
        std::vector<fs::path> lists;
        std::error_code error;
        std::size_t visited = 0;
        constexpr auto option = fs::directory_options::skip_permission_denied;
        fs::recursive_directory_iterator entry{folder, option, error};
        for (; !error && entry != fs::recursive_directory_iterator{}; entry.increment(error)) {
            const bool is_hidden = entry->path().filename().string().starts_with('.');
            if (is_hidden || static_cast<std::size_t>(entry.depth()) >= max_depth) {
                entry.disable_recursion_pending();
            }
            std::error_code ignored;
            if (++visited > max_visited) {
                return misconfigured(folder.string(),
                                     "has more than " + std::to_string(max_visited) + " entries");
            }
            if (is_hidden || !entry->is_regular_file(ignored)) {
                continue;
            }
            if (entry.depth() == 0 && is_list(entry->path())) {
                lists.push_back(entry->path());
            } else if (has_ending(entry->path(), program_endings)) {
                files.push_back(entry->path());
            }
        }
        if (error) {
            return misconfigured(folder.string(), "cannot be read: " + error.message(),
                                 status::Bad_NotFound);
        }
        if (lists.size() > 1) {
            return misconfigured(folder.string(),
                                 "has " + std::to_string(lists.size()) +
                                     " .plcproj; expected the path of one of them");
        }
        return lists.empty() ? add_files(folder, std::move(files)) : add(lists.front());
    }

    Configured<void> add_files(const fs::path& folder, std::vector<fs::path> files)
    {
        if (files.empty()) {
            return misconfigured(folder.string(),
                                 "found no file of a program in the folder; expected names that "
                                 "end with .st, .xml, .TcGVL, .TcDUT, .csv or the like");
        }
        std::sort(files.begin(), files.end());
        const auto root = canonical(folder);
        for (const fs::path& file : files) {
            if (auto added = add_file(file, file.lexically_relative(folder), root); !added) {
                return added;
            }
        }
        return {};
    }

    /// Adds what a .plcproj compiles.
    Configured<void> add_list(const fs::path& path, const std::string& text)
    {
        if (text.size() > max_list_size) {
            return misconfigured(path.string(),
                                 "found more than " + std::to_string(max_list_size) +
                                     " bytes of a list of files (.plcproj)",
                                 status::Bad_EncodingLimitsExceeded);
        }
        pugi::xml_document document;
        if (const auto parsed = document.load_buffer(text.data(), text.size()); !parsed) {
            return misconfigured(path.string(),
                                 std::string{"is not well-formed XML: "} + parsed.description());
        }
        const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path{"."};
        CaselessFolder names{folder};
        const auto root = canonical(folder);
        const std::vector<fs::path> compiled = compiled_files(document);
        for (const fs::path& file : compiled) {
            if (auto added = add_item(file, folder, names, root); !added) {
                return added;
            }
        }
        if (compiled.empty()) {
            return misconfigured(path.string(),
                                 "compiles no file with declarations; expected .TcGVL, .TcDUT, "
                                 ".TcPOU or .TcIO in its <Compile Include>");
        }
        return {};
    }

    Configured<void> add_item(const fs::path& named, const fs::path& folder, CaselessFolder& names,
                              const std::optional<fs::path>& root)
    {
        const fs::path relative = named.lexically_normal();
        const bool leaves = relative.is_absolute() ||
                            named.string().find(':') != std::string::npos ||
                            *relative.begin() == "..";
        if (leaves) {
            return add_missing(relative, folder / relative,
                               "is outside of the folder of the list of files; copy it there, or "
                               "name it as a file of the program");
        }
        const fs::path file = names.find(relative);
        return add_file(file, file.lexically_relative(folder), root);
    }

    /// Adds a file that was found, unless it is elsewhere in truth. `name` is its path from the
    /// folder that it was found in, so that the same folder elsewhere gives the same text.
    Configured<void> add_file(const fs::path& file, const fs::path& name,
                              const std::optional<fs::path>& root)
    {
        const auto place = canonical(file);
        if (!place) {
            return add_missing(name, file, "the file is missing");
        }
        const bool is_inside =
            root && std::mismatch(root->begin(), root->end(), place->begin(), place->end()).first ==
                        root->end();
        if (!is_inside) {
            return add_missing(name, file, "is a link to a file outside of the folder");
        }
        if (seen_.contains(place->string())) {
            return {}; // without reading it again, however often a list names it
        }
        auto text = text_of(file, max_size_);
        if (text) {
            return add_text(file, name, *text);
        }
        return text.error().status == status::Bad_EncodingLimitsExceeded
                   ? Unexpected{std::move(text).error()}
                   : add_missing(name, file, text.error().text);
    }

    Configured<void> add_text(const fs::path& path, const fs::path& name, const std::string& text)
    {
        const auto place = canonical(path);
        if (place && !seen_.insert(place->string()).second) {
            return {};
        }
        return add_entry(BundleEntry::Kind::File, own_name(name, path), text);
    }

    Configured<void> add_missing(const fs::path& name, const fs::path& path, const std::string& why)
    {
        return add_entry(BundleEntry::Kind::Missing, own_name(name, path), why);
    }

    /// Returns the name, or the whole path if another file of the program has this name.
    std::string own_name(const fs::path& name, const fs::path& path)
    {
        std::string text = name.generic_string();
        return names_.insert(text).second ? text : path.generic_string();
    }

    Configured<void> add_entry(BundleEntry::Kind kind, std::string name, const std::string& text)
    {
        std::replace(name.begin(), name.end(), '\n', ' ');
        if (name.size() > detail::max_bundle_name) {
            return misconfigured(printable(name), "is a name of more than " +
                                                      std::to_string(detail::max_bundle_name) +
                                                      " bytes");
        }
        if (++count_ > detail::max_bundle_files) {
            return misconfigured(name, "is one more than " +
                                           std::to_string(detail::max_bundle_files) + " files");
        }
        if (bundle_.size() + text.size() + name.size() > max_size_) {
            return misconfigured(name,
                                 "found more than " + std::to_string(max_size_) +
                                     " bytes with the files before it",
                                 status::Bad_EncodingLimitsExceeded);
        }
        bundle_.add(kind, name, text);
        return {};
    }

    static std::optional<fs::path> canonical(const fs::path& path)
    {
        std::error_code error;
        fs::path place = fs::canonical(path, error);
        return error ? std::nullopt : std::optional{std::move(place)};
    }

    std::size_t max_size_;
    std::size_t count_{0};
    std::set<std::string> seen_{};
    std::set<std::string> names_{};
    detail::BundleWriter bundle_{};
};

} // namespace

Configured<std::string> read_program_files(const std::string& paths, std::size_t max_size)
{
    FileCollector files{max_size};
    std::error_code ignored;
    const bool is_one = paths.find('\n') == std::string::npos;
    if (is_one && !fs::is_directory(paths, ignored)) {
        auto text = text_of(paths, max_size);
        if (!text || !is_list(fs::path{paths}, *text)) {
            return text;
        }
    }
    std::string_view rest = paths;
    while (!rest.empty()) {
        const std::string_view path = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), path.size() + 1));
        if (auto added = path.empty() ? Configured<void>{} : files.add(fs::path{path}); !added) {
            return Unexpected{std::move(added).error()};
        }
    }
    return files.take();
}

bool is_program_list(const std::string& path)
{
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) {
        return is_list(fs::path{path});
    }
    const auto text = text_of(path, max_list_size);
    return text ? is_list(fs::path{path}, *text) : is_list(fs::path{path});
}

} // namespace busbar::controller
