#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "failure.hpp"
#include "tool/printing/output.hpp"

namespace CLI {
class App;
}

namespace busbar::tool {

/// True if the text probably means a server rather than a node: opc.tcp://host:4840/path, another
/// scheme, or host:4840.
[[nodiscard]] bool is_url(std::string_view text);

/// Returns the URL in the form that the library takes, with the scheme if that was left out. Throws
/// a Failure, which says what is wrong, for a text that is not a URL.
[[nodiscard]] std::string complete_url(const std::string& text);

/// The host of a complete URL.
[[nodiscard]] std::string host_of(const std::string& url);

/// The options that all commands have.
struct Options {
    /// Empty until complete_options().
    std::string url;
    std::string profile;
    /// Names of those that the command line has.
    std::set<std::string> given;
    std::string user;
    std::string password;
    std::string password_file;
    std::string user_certificate;
    std::string user_key;
    /// Short names of security policies; empty: all good ones.
    std::vector<std::string> policies;
    /// "Sign" or "SignAndEncrypt".
    std::string mode{"SignAndEncrypt"};
    bool is_insecure{false};
    /// If empty, the folder below the user's data folder.
    std::string pki;
    bool trusts{false};
    /// Steps of the check of the server's certificate.
    std::vector<std::string> ignored;
    double timeout{20}; // seconds
    bool is_verbose{false};
    bool is_json{false};
    /// File for the keys of channels; empty for none.
    std::string key_log;
};

/// The objects that a command works with.
struct Context {
    Options options;
    Output out{stdout};
    Output err{stderr};

    /// "busbar: <label>: <text>" on standard error, in lines that fit a terminal.
    void warn(const std::string& label, const std::string& text);
};

/// Carries a command out; throws Failure or OutputClosed.
using Run = std::function<Exit(Context&)>;
/// Makes `function` what is carried out if the command line has `command`.
void when_chosen(CLI::App& command, Run& run, Run function);

/// Adds the options to the program.
void add_options(CLI::App& app, Options& options);
/// Checks values of an option that are not from the command line; returns what is wrong, empty if
/// they are right.
[[nodiscard]] std::string check_option(const std::string& name,
                                       const std::vector<std::string>& values);
/// Returns the command line as CLI11 expects it, last argument first. CLI11 would take "[1, 2]" for
/// two arguments and does not know -- before positional ones: a mark before such arguments protects
/// them, and unmark() removes it.
[[nodiscard]] std::vector<std::string> protected_arguments(int count, char** arguments);
void unmark(std::string& argument);
/// Takes the URL, or the @NAME of a profile, off the front of a command's arguments if there is one
/// and at least `others` more, and marks off all.
void take_url(std::vector<std::string>& arguments, Options& options, std::size_t others = 0);
/// The same for a command that has no other argument; throws Failure if there is one.
void take_only_url(std::vector<std::string>& arguments, Options& options);
/// The same for a command that needs another argument; throws Failure if there is none.
void take_url_before(std::vector<std::string>& arguments, Options& options);

struct Options;

/// The options of one server by their names, as a file of profiles has them.
using Profile = std::map<std::string, std::vector<std::string>>;

/// Returns the path of the file of profiles: busbar/profiles.toml below XDG_CONFIG_HOME or
/// ~/.config. Empty if neither is set.
[[nodiscard]] std::string profiles_file();
/// Returns the profiles in a text by their names; `file` is for messages. Throws Failure for a key
/// that is not an option of a connection, and for a password, which must be in a separate file.
[[nodiscard]] std::map<std::string, Profile> parse_profiles(const std::string& text,
                                                            const std::string& file);
/// The names in profiles_file(); none if there is no such file or it is wrong.
[[nodiscard]] std::vector<std::string> profile_names();

/// Options that were given on the command line, which count before those of a profile.
[[nodiscard]] std::set<std::string> given_options(const CLI::App& app);
/// Puts the profile of that name into the options that were not given. Throws Failure if there is
/// none.
void apply_profile(const std::string& name, Options& options);
/// Adds what the command line did not say: the profile of --profile or BUSBAR_PROFILE, then the URL
/// of BUSBAR_URL or the usual one. Throws Failure.
void complete_options(Options& options);

} // namespace busbar::tool
