#pragma once

#include <string>
#include <utility>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar {

struct Refusal;

/// What is wrong with something that a human configured: a server's or client's configuration, its
/// environment, a simulated PLC, a NodeSet file, a file of settings. For the person who wrote it;
/// what a peer did wrong is a Refusal. Never holds a secret, and nothing but printable text.
struct Problem {
    /// Never Good. Bad_ConfigurationError unless another code says more.
    StatusCode status{status::Bad_ConfigurationError};
    /// What it is about, as its author finds it: "endpoint_url", "variables[2].type",
    /// "controller.toml:12: scan_ms", "tags.xml:17: ns=1;i=5". Empty: all of it.
    std::string where{};
    /// What was found and, where it helps, what was expected.
    std::string text{};
};

/// What is made of a configuration: a value, or the problem that there is with it.
template <typename T>
using Configured = Expected<T, Problem>;

/// `return misconfigured("endpoint_url", "is empty");` in a function that returns a Configured.
[[nodiscard]] inline Unexpected<Problem>
misconfigured(std::string where, std::string text, StatusCode code = status::Bad_ConfigurationError)
{
    return Unexpected<Problem>{Problem{code, std::move(where), std::move(text)}};
}

/// The problem as one line: "endpoint_url: is empty", and behind it the status in parentheses if
/// that is not Bad_ConfigurationError.
[[nodiscard]] BUSBAR_API std::string text(const Problem& problem);

/// A refusal of what somebody configured, as a certificate of one's own: `where` is the check, and
/// the text has what was found, the certificate, the rule and the remedy.
[[nodiscard]] BUSBAR_API Problem problem_of(const Refusal& refusal);

} // namespace busbar
