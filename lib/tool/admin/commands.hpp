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

/// What `busbar admin log` shows, or does instead.
struct LogChoice {
    std::string category;
    std::string code;
    std::string text;
    std::size_t count{100};
    bool is_followed{false};
    bool is_cleared{false};
    std::string folder;
};

/// What `busbar admin events` shows; empty: all.
struct PastEventChoice {
    std::string level;
    std::string code;
    std::size_t count{20};
};

/// What of a controller's memory is meant.
struct BackupOptions {
    bool without_security{false};
    /// A RestoreCommand.ini, by which it is decided instead.
    std::string command_file;
    bool clears_security{false};
};

/// What they take.
struct AdminArguments {
    /// [URL] and whatever the subcommand names.
    std::vector<std::string> words;
    bool is_of_users{false};
    /// Instead of one user.
    bool is_everyone{false};
    bool is_issuer{false};
    TrustOrder order;
    /// Asks nothing.
    bool is_sure{false};
    /// A project counts although labels of it cannot be used.
    bool despite_labels{false};
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
    /// Where the program goes that a controller runs.
    std::string save_to;
};

/// Carries a subcommand out; throws Failure.
using Action = Exit (*)(Context&, Connection&, const AdminArguments&);

/// Adds subcommands to the group and has the program run the one that is given.
class Group {
public:
    Group(CLI::App& parent, Run& run, const char* name, const char* text);

    /// `words`: how many it needs besides the URL, and what they are called: "NAME ROLE".
    CLI::App* add(const char* name, const char* text, std::size_t words, const char* word_names,
                  Action action, Connection::Endurance endurance = Connection::Endurance::Short);
    /// The same for one that takes any number of words and sees for itself whether they are enough.
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

/// Throws Failure unless the user says yes, or has said so with --yes.
void make_sure(Context& context, const AdminArguments& arguments, const std::string& question);
/// Stops the server, or restarts it if the arguments say so.
Exit shut_down(Context& context, Connection& connection, const AdminArguments& arguments);
/// "done", or {"done": what}.
Exit report(Context& context, const std::string& what);

} // namespace busbar::tool::admin
