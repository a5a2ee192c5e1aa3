#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tool/connection/connection.hpp"
#include "tool/stream/stream.hpp"
#include "trust_table.hpp"

/// The subcommands of `busbar admin`, one file for each subject.
namespace busbar::tool::admin {

/// The filter of `busbar admin log`, and what it does instead of showing entries.
struct LogChoice {
    std::string category;
    std::string code;
    std::string text;
    std::size_t count{100};
    bool is_followed{false};
    bool is_cleared{false};
    std::string folder;
};

/// The filter of `busbar admin events`; empty members select everything.
struct PastEventChoice {
    std::string level;
    std::string code;
    std::size_t count{20};
};

/// The parts of a controller's memory to save, restore or clear.
struct BackupOptions {
    bool without_security{false};
    /// A RestoreCommand.ini that decides instead.
    std::string command_file;
    /// A variable of the controller's program decides instead.
    bool is_by_variable{false};
    bool clears_security{false};
};

/// The arguments of the subcommands.
struct AdminArguments {
    /// [URL] and the words of the subcommand.
    std::vector<std::string> words;
    bool is_of_users{false};
    /// Applies to all users instead of one.
    bool is_everyone{false};
    bool is_issuer{false};
    TrustOrder order;
    /// Does not ask.
    bool is_sure{false};
    /// Uses a project although some of its labels cannot be used.
    bool despite_labels{false};
    /// Takes a program that leaves out more than the one that runs.
    bool leaves_out{false};
    std::string new_password_file;
    std::string description;
    bool must_change{false};
    bool only_changed{false};
    std::string subject;
    std::vector<std::string> hosts;
    unsigned days{7'305}; // twenty years
    unsigned seconds{2};
    std::string reason;
    bool restarts{false};
    StreamEnd end;
    LogChoice log;
    PastEventChoice events;
    BackupOptions backup;
    /// File for the program of a controller.
    std::string save_to;
};

/// Carries a subcommand out; throws Failure.
using Action = Exit (*)(Context&, Connection&, const AdminArguments&);

/// Adds subcommands to the group and makes the program run the chosen one.
class Group {
public:
    Group(CLI::App& parent, Run& run, const char* name, const char* text);

    /// `words` is the number of words needed besides the URL, `word_names` their names: "NAME
    /// ROLE".
    CLI::App* add(const char* name, const char* text, std::size_t words, const char* word_names,
                  Action action, Connection::Endurance endurance = Connection::Endurance::Short);
    /// The same for a subcommand that takes any number of words and checks them itself.
    CLI::App* add_any(const char* name, const char* text, const char* word_names, Action action);
    [[nodiscard]] AdminArguments& arguments() { return *arguments_; }

private:
    CLI::App* add(const char* name, const char* text, const char* word_names,
                  std::optional<std::size_t> words, Action action, Connection::Endurance endurance);

    CLI::App* app_;
    Run* run_;
    std::shared_ptr<AdminArguments> arguments_{std::make_shared<AdminArguments>()};
};

void add_status(CLI::App& admin, Run& run);
void add_trust(CLI::App& admin, Run& run);
void add_users(CLI::App& admin, Run& run);
void add_roles(CLI::App& admin, Run& run);
void add_own(CLI::App& admin, Run& run);
void add_settings(CLI::App& admin, Run& run);
void add_files(CLI::App& admin, Run& run);
void add_audit(CLI::App& admin, Run& run);
void add_log(CLI::App& admin, Run& run);
void add_events(CLI::App& admin, Run& run);
void add_backup(CLI::App& admin, Run& run);
void add_program(CLI::App& admin, Run& run);
void add_mode(CLI::App& admin, Run& run);
void add_setup(CLI::App& admin, Run& run);
void add_shutdown(CLI::App& admin, Run& run);

/// Asks the user, unless --yes is given; throws Failure without a yes.
void make_sure(Context& context, const AdminArguments& arguments, const std::string& question);
/// Stops the server, or restarts it, as the arguments say.
Exit shut_down(Context& context, Connection& connection, const AdminArguments& arguments);
/// Prints what was done, as a line or as {"done": what}.
Exit report(Context& context, const std::string& what);

} // namespace busbar::tool::admin
