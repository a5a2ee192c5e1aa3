#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "failure.hpp"
#include "tool/printing/output.hpp"
#include "url.hpp"

namespace CLI {
class App;
}

namespace busbar::tool {

/// The options that all commands have.
struct Options {
    /// Empty until complete_options().
    std::string url;
    std::string profile;
    /// Names of those that the command line has, see profile.hpp.
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
    /// Steps of the check of the server's certificate, see ignored_steps.hpp.
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

} // namespace busbar::tool
