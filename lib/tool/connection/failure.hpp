#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/status_code.hpp>

#include "tool/printing/output.hpp"

namespace busbar::tool {

/// What the program ends with. Part of its interface: scripts go by it.
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
    /// Why, as the server says it; empty if it does not. Shown instead of the status's meaning.
    std::string reason{};
    /// What the user can do; may be empty.
    std::string hint;
    /// What a text that fits several things may have meant, each to be given instead of it; mostly
    /// there are none.
    std::vector<std::string> candidates;
};

/// What the server refused, with the additionalInfo that it gave of it, of an operation that it
/// calls `operand` there. A known reason takes the place of the status's meaning and hint.
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

[[nodiscard]] Exit exit_of(StatusCode status);

/// For people: one line for what failed and the status, one for what to do.
[[nodiscard]] std::string text_of(const Failure& failure, const Output& out);
/// {"error": {...}} for scripts.
[[nodiscard]] std::string json_of(const Failure& failure);

} // namespace busbar::tool
