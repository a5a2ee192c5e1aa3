#include "context.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <CLI/CLI.hpp>

#include "failure.hpp"
#include "tool/printing/file.hpp"

namespace busbar::tool {

namespace {

namespace fs = std::filesystem;

std::string variable(const char* name)
{
    const char* const text = std::getenv(name);
    return text == nullptr ? std::string{} : std::string{text};
}

/// "~/x" is below the home folder, and a relative path below that of the file of profiles.
std::string path_of(const std::string& text)
{
    if (text.starts_with("~/")) {
        return (fs::path{variable("HOME")} / text.substr(2)).string();
    }
    const fs::path path{text};
    return path.is_relative() ? (fs::path{profiles_file()}.parent_path() / path).string() : text;
}

bool is_true(const std::string& text, const std::string& name)
{
    if (text != "true" && text != "false") {
        throw Failure{Exit::Usage, name + ": expected true or false, found " + text};
    }
    return text == "true";
}

double seconds_of(const std::string& text)
{
    char* end = nullptr;
    const double seconds = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end != '\0' || !(seconds >= 0.1 && seconds <= 86'400)) {
        throw Failure{Exit::Usage, "timeout: expected seconds, 0.1 to 86400, found " + text};
    }
    return seconds;
}

struct ProfileKey {
    const char* name;
    void (*put)(const std::vector<std::string>& values, Options& options);
};
constexpr ProfileKey keys[] = {
    {"url", [](const auto& values, Options& to) { to.url = values.front(); }},
    {"user", [](const auto& values, Options& to) { to.user = values.front(); }},
    {"password-file",
     [](const auto& values, Options& to) { to.password_file = path_of(values.front()); }},
    {"user-certificate",
     [](const auto& values, Options& to) { to.user_certificate = path_of(values.front()); }},
    {"user-key", [](const auto& values, Options& to) { to.user_key = path_of(values.front()); }},
    {"policy", [](const auto& values, Options& to) { to.policies = values; }},
    {"mode", [](const auto& values, Options& to) { to.mode = values.front(); }},
    {"insecure",
     [](const auto& values, Options& to) { to.is_insecure = is_true(values.front(), "insecure"); }},
    {"pki", [](const auto& values, Options& to) { to.pki = path_of(values.front()); }},
    {"ignore", [](const auto& values, Options& to) { to.ignored = values; }},
    {"timeout", [](const auto& values, Options& to) { to.timeout = seconds_of(values.front()); }},
};

std::vector<std::string> key_names()
{
    std::vector<std::string> names;
    for (const ProfileKey& key : keys) {
        names.emplace_back(key.name);
    }
    return names;
}

/// Throws Failure for what is not an option of a connection.
void check_key(const std::string& key, const std::string& where)
{
    if (key == "password") {
        throw Failure{Exit::Usage, where + ": a password is not kept in a file of profiles",
                      "put it into a file of its own that only you can read, and name that with "
                      "password-file"};
    }
    const auto names = key_names();
    if (std::find(names.begin(), names.end(), key) == names.end()) {
        const std::string meant = nearest(key, names);
        throw Failure{Exit::Usage, where + ": there is no such key",
                      meant.empty() ? "there are " + joined(names)
                                    : "perhaps " + meant + " is meant"};
    }
}

std::map<std::string, Profile> read_profiles(const std::string& file)
{
    return parse_profiles(read_file(file), file);
}

} // namespace

std::string profiles_file()
{
    const std::string folder = variable("XDG_CONFIG_HOME");
    const std::string home = variable("HOME");
    const fs::path base = folder.starts_with('/') ? fs::path{folder}
                          : home.empty()          ? fs::path{}
                                                  : fs::path{home} / ".config";
    return base.empty() ? std::string{} : (base / "busbar" / "profiles.toml").string();
}

std::map<std::string, Profile> parse_profiles(const std::string& text, const std::string& file)
{
    std::map<std::string, Profile> profiles;
    std::istringstream stream{text};
    std::vector<CLI::ConfigItem> items;
    try {
        items = CLI::ConfigTOML{}.from_config(stream);
    } catch (const CLI::Error& error) {
        throw Failure{Exit::Usage, file + ": " + error.what()};
    }
    for (const CLI::ConfigItem& item : items) {
        if (item.name == "++" || item.name == "--") { // where a table begins and ends
            continue;
        }
        const std::string where = file + ": " + item.fullname();
        if (item.parents.size() != 1 || item.parents.front() == "default") {
            throw Failure{Exit::Usage, where + ": it belongs to no profile",
                          "a profile begins with its name, as in [press]"};
        }
        check_key(item.name, where);
        if (item.inputs.empty() || item.inputs.front().empty()) {
            throw Failure{Exit::Usage, where + ": it has no value"};
        }
        profiles[item.parents.front()][item.name] = item.inputs;
    }
    return profiles;
}

std::vector<std::string> profile_names()
{
    std::vector<std::string> names;
    try {
        for (const auto& [name, profile] : read_profiles(profiles_file())) {
            names.push_back(name);
        }
    } catch (const Failure&) {
        return {};
    }
    return names;
}

std::set<std::string> given_options(const CLI::App& app)
{
    std::set<std::string> given;
    for (const CLI::Option* option : app.get_options()) {
        if (option->count() > 0 && !option->get_lnames().empty()) {
            given.insert(option->get_lnames().front());
        }
    }
    return given;
}

void apply_profile(const std::string& name, Options& options)
{
    const std::string file = profiles_file();
    std::error_code ignored;
    if (file.empty() || !fs::exists(file, ignored)) {
        throw Failure{Exit::Usage, name + ": there is no file of profiles",
                      "write " + (file.empty() ? "~/.config/busbar/profiles.toml" : file) +
                          " with [" + name + "] and url = \"opc.tcp://host:4840\""};
    }
    const auto profiles = read_profiles(file);
    const auto found = profiles.find(name);
    if (found == profiles.end()) {
        std::vector<std::string> names;
        names.reserve(profiles.size());
        for (const auto& [each, profile] : profiles) {
            names.push_back(each);
        }
        throw Failure{Exit::Usage, name + ": no profile of this name in " + file,
                      "there are " + joined(names)};
    }
    const std::string place = file + ": " + name + ".";
    for (const ProfileKey& key : keys) {
        const auto values = found->second.find(key.name);
        if (values == found->second.end() || options.given.contains(key.name)) {
            continue;
        }
        try {
            key.put(values->second, options);
        } catch (const Failure& failure) {
            throw Failure{Exit::Usage, std::string{place}.append(failure.what())};
        }
        const std::string problem = check_option(key.name, values->second);
        if (!problem.empty()) {
            throw Failure{Exit::Usage,
                          std::string{place}.append(key.name).append(": ").append(problem)};
        }
    }
}

void complete_options(Options& options)
{
    if (options.profile.empty()) {
        options.profile = variable("BUSBAR_PROFILE");
    }
    if (!options.profile.empty()) {
        apply_profile(options.profile, options);
    }
    if (options.url.empty()) {
        options.url = variable("BUSBAR_URL");
    }
    if (options.url.empty()) {
        options.url = "opc.tcp://localhost:4840";
    }
}

} // namespace busbar::tool
