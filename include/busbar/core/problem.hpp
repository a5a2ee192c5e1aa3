#pragma once

#include <string>
#include <utility>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar {

struct Refusal;

/// Says what is wrong with something that a human configured: a server's or client's configuration,
/// its environment, a simulated PLC, a NodeSet file, a settings file. It is written for that
/// person; a peer's mistake is a Refusal. Holds only printable text and never a secret.
struct Problem {
    /// Never Good. Bad_ConfigurationError unless another code says more.
    StatusCode status{status::Bad_ConfigurationError};
    /// The subject as its author finds it: "endpoint_url", "variables[2].type",
    /// "controller.toml:12: scan_ms", "tags.xml:17: ns=1;i=5". Empty if it is the whole
    /// configuration.
    std::string where{};
    /// The finding and, if it helps, the expected value.
    std::string text{};
};

/// The result of reading a configuration: a value, or the problem with it.
template <typename T>
using Configured = Expected<T, Problem>;

/// `return misconfigured("endpoint_url", "is empty");` in a function that returns a Configured.
[[nodiscard]] inline Unexpected<Problem>
misconfigured(std::string where, std::string text, StatusCode code = status::Bad_ConfigurationError)
{
    return Unexpected<Problem>{Problem{code, std::move(where), std::move(text)}};
}

/// The problem as one line: "endpoint_url: is empty", followed by the status in parentheses unless
/// it is Bad_ConfigurationError.
[[nodiscard]] BUSBAR_API std::string text(const Problem& problem);

/// Turns the refusal of something that was configured, such as the own certificate, into a Problem:
/// `where` is the check, and the text has what was found, the certificate, the rule and the remedy.
[[nodiscard]] BUSBAR_API Problem problem_of(const Refusal& refusal);

} // namespace busbar
