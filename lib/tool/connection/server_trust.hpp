#pragma once

#include <optional>
#include <set>
#include <string>

#include <busbar/crypto/store_validator.hpp>

#include "context.hpp"
#include "pki.hpp"
#include "tool/nodes/ignored_steps.hpp"

namespace busbar::tool {

/// Decides on servers' certificates by the store, and remembers the one that it refused, so that
/// the user can be asked when the attempt has ended.
class ServerTrust final : public crypto::CertificateValidator {
public:
    /// All must outlive this. `context` is warned of each step that its options suppress.
    ServerTrust(Pki& pki, Context& context, LogSink& log)
        : pki_{&pki}, context_{&context}, validator_{pki.store(), log,
                                                     settings_of(context.options.ignored)}
    {
    }

    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override;

    /// Whether the last attempt to connect failed here.
    [[nodiscard]] bool has_refused() const { return refused_.has_value(); }
    /// Trusts what was refused, if the options say so or the user does, who is asked on a terminal.
    /// True if it is worth another attempt.
    [[nodiscard]] bool reconsider(Context& context);
    /// What was refused, why, and how to trust it.
    [[nodiscard]] Failure failure() const;

private:
    struct Refused {
        crypto::Certificate leaf;
        Refusal why;
    };

    void warn_of_suppressed();

    Pki* pki_;
    Context* context_;
    crypto::StoreValidator validator_;
    std::optional<Refused> refused_;
    /// Whose certificate is asked for twice on the way to a session; told is it once.
    std::set<std::string> warned_;
};

/// Asks on standard error and reads from standard input; false if either is no terminal.
[[nodiscard]] bool confirm(Context& context, const std::string& question);

} // namespace busbar::tool
