#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/store_validator.hpp>

#include "context.hpp"
#include "pki.hpp"

namespace busbar::tool {

/// Steps of the check of a server's certificate that `--ignore` suppresses, by their names.
[[nodiscard]] std::vector<std::string> ignorable_steps();
/// Returns settings that suppress the steps with these names and no others.
[[nodiscard]] crypto::ValidationSettings settings_of(const std::vector<std::string>& steps);
/// "--ignore host-name" for the step that fails with this status; empty for one that always counts.
[[nodiscard]] std::string switch_for(StatusCode status);

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

    /// True if the last attempt to connect failed because of the certificate.
    [[nodiscard]] bool has_refused() const { return refused_.has_value(); }
    /// Trusts the refused certificate if the options, or the user after a question on a terminal,
    /// say so. True if the connection should be tried again.
    [[nodiscard]] bool reconsider(Context& context);
    /// Explains the refusal and how to trust the certificate.
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
    /// Certificates that were already reported: each is checked twice on the way to a session.
    std::set<std::string> warned_;
};

/// Asks on standard error and reads from standard input; false if one of them is not a terminal.
[[nodiscard]] bool confirm(Context& context, const std::string& question);

} // namespace busbar::tool
