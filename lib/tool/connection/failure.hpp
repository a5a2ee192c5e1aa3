#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/status_code.hpp>

#include "tool/printing/output.hpp"

namespace CLI {
class App;
class ParseError;
} // namespace CLI

namespace busbar::tool {

/// The exit codes of the program. They are part of its interface, because scripts use them.
enum class Exit : int {
    Good = 0,
    Failed = 1,       // the server, or the disk, said no
    Usage = 2,        // the command line is wrong
    NotConnected = 3, // no server there, or it went away
    Refused = 4,      // security: a certificate, the user, or what the endpoint offers
    Partly = 5,       // some of several nodes failed, the others did not
    HungUp = 129,     // the terminal of `busbar watch` went away, as shells have it for SIGHUP
    Interrupted = 130 // by Ctrl+C, as shells have it for SIGINT
};

/// The user pressed Ctrl+C.
struct Interrupted {};

/// Ends a command. `what()` says what was tried and failed.
class Failure final : public std::runtime_error {
public:
    Failure(Exit code, const std::string& what, std::string advice = {})
        : std::runtime_error{what}, exit{code}, hint{std::move(advice)}
    {
    }
    /// The exit code and the hint follow from the status; `advice` replaces that hint.
    Failure(StatusCode code, const std::string& what, std::string advice = {});

    Exit exit;
    /// Good if no service or connection is to blame.
    StatusCode status;
    /// The server's reason, shown instead of the status's meaning; empty if it gave none.
    std::string reason{};
    /// Advice for the user; may be empty.
    std::string hint;
    /// Texts that the user may have meant by an ambiguous one; usually empty.
    std::vector<std::string> candidates;
};

/// Makes a failure from a server's refusal and its additionalInfo about an operation that the
/// server calls `operand`. A known reason replaces the status's meaning and hint.
[[nodiscard]] Failure refused_by_server(StatusCode status, const std::string& what,
                                        std::string_view additional_info, std::string_view operand);
/// The reason in it; empty if there is none.
[[nodiscard]] std::string_view reason_in(std::string_view additional_info,
                                         std::string_view operand);

/// The first ten of them, each on a line of its own that can be pasted into a shell.
[[nodiscard]] std::string lines_of(const std::vector<std::string>& candidates);

/// No connection could be made to `url`; `why` is the system's reason, or empty.
[[nodiscard]] Failure connect_failure(StatusCode status, const std::string& url,
                                      const std::string& why);

/// This side ended the connection with `status`, since it does not accept what `refusal` says of
/// the server.
[[nodiscard]] Failure refused_by_us(StatusCode status, const std::string& what,
                                    const std::string& refusal);

[[nodiscard]] Exit exit_of(StatusCode status);

/// For people: one line for what failed and the status, one for what to do.
[[nodiscard]] std::string text_of(const Failure& failure, const Output& out);
/// {"error": {...}} for scripts.
[[nodiscard]] std::string json_of(const Failure& failure);

/// A StatusCode in plain words; both are empty for one that has none here.
struct StatusHelp {
    std::string_view meaning;
    /// Advice for the user; may be empty.
    std::string_view hint;
};

[[nodiscard]] StatusHelp help_for(StatusCode status);

/// "a, b, c".
[[nodiscard]] std::string joined(const std::vector<std::string>& words);
/// Names of the options of `app` and, since they are offered everywhere, of the program.
[[nodiscard]] std::vector<std::string> options_of(const CLI::App& app);

/// The candidate that `word` is most likely a misspelling of; empty if none is near.
[[nodiscard]] std::string nearest(std::string_view word,
                                  const std::vector<std::string>& candidates);

/// Says that `level` has no command of this name, and names the one that was probably meant.
[[nodiscard]] Failure unknown_command(const CLI::App& level, const std::string& word);
/// Explains an error of the command line: the unknown word, and the one that was probably meant.
[[nodiscard]] Failure usage_failure(const CLI::App& app, const CLI::ParseError& error);

} // namespace busbar::tool
