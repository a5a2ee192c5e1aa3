#pragma once

#include <string>
#include <string_view>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar {

/// Says why a connection, message, certificate, token or user was refused, for the operator of this
/// machine. The peer is told no more than Part 4, 6.1.3 and Part 6, 6.7.7 allow; the log gets
/// everything. Never holds a secret; text from a peer has passed `printable`.
struct Refusal {
    StatusCode status;
    /// The check that failed: "Trust List Check", "user name and password".
    std::string_view check;
    /// The finding and, if it helps, the expected value.
    std::string found;
    /// The rule that requires the check: "Part 4, 6.1.3, Table 100".
    std::string_view rule;
    /// The operator's remedy; empty if there is none, as for a forged message.
    std::string remedy;
    /// Subject of the certificate that it is about; empty if it is about none.
    std::string subject{};
    std::string thumbprint{};
};

/// The result of a check that can refuse: a value, or the refusal.
template <typename T>
using Checked = Expected<T, Refusal>;

/// `return refuse(...);` in a function that returns a Checked.
[[nodiscard]] inline Unexpected<Refusal> refuse(Refusal refusal)
{
    return Unexpected<Refusal>{std::move(refusal)};
}

/// The refusal as one line:
/// "Trust List Check failed: neither ... nor ... (CN=Line 3, 01AB...): Bad_CertificateUntrusted,
/// Part 4, 6.1.3, Table 100. Move it from rejected to trusted."
[[nodiscard]] BUSBAR_API std::string text(const Refusal& refusal);

/// The refusal in a form for the user concerned, without its status and rule: "user name rules: it
/// has 3 characters, expected 4 to 32. Choose another one that fits the rules".
[[nodiscard]] BUSBAR_API std::string reason_of(const Refusal& refusal);

/// Writes that line as a warning. The code that answers the peer calls it, once for each refusal.
BUSBAR_API void explain(LogSink& log, std::string_view source, const Refusal& refusal);

} // namespace busbar
