#pragma once

#include <string>
#include <string_view>

#include <busbar/core/expected.hpp>

#include <busbar/core/api.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar {

/// Why a connection, message, certificate, token or user was refused, for the operator of this
/// machine. The peer is told no more than Part 4, 6.1.3 and Part 6, 6.7.7 allow; the log says it
/// all. Never holds a secret; what a peer sent has passed `printable`.
struct Refusal {
    StatusCode status;
    /// Which check failed: "Trust List Check", "user name and password".
    std::string_view check;
    /// What was found and, where it helps, what was expected.
    std::string found;
    /// Which rule asks for the check: "Part 4, 6.1.3, Table 100".
    std::string_view rule;
    /// What the operator can do; empty if there is nothing to do, as with a forged message.
    std::string remedy;
    /// The certificate that it is about, empty if it is about none.
    std::string subject{};
    std::string thumbprint{};
};

/// The result of a check that can refuse: a value, or the refusal.
template <typename T>
using Checked = Expected<T, Refusal>;

[[nodiscard]] inline Unexpected<Refusal> refuse(Refusal refusal)
{
    return Unexpected<Refusal>{std::move(refusal)};
}

/// The refusal as one line:
/// "Trust List Check failed: neither ... nor ... (CN=Line 3, 01AB...): Bad_CertificateUntrusted,
/// Part 4, 6.1.3, Table 100. Move it from rejected to trusted."
[[nodiscard]] BUSBAR_API std::string text(const Refusal& refusal);

/// The refusal for the user who asked, without its status and rule:
/// "user name rules: it has 3 characters, expected 4 to 32. Choose another one that fits the
/// rules".
[[nodiscard]] BUSBAR_API std::string reason_of(const Refusal& refusal);

/// Writes that line as a warning. Whoever answers the peer calls it, once for each refusal.
BUSBAR_API void explain(LogSink& log, std::string_view source, const Refusal& refusal);

} // namespace busbar
