#pragma once

#include <optional>
#include <string>

#include <busbar/client/user_identity.hpp>
#include <busbar/crypto/secret.hpp>

#include "context.hpp"
#include "pki.hpp"
#include "server_trust.hpp"

namespace busbar::tool {

/// Our certificate, and the decision on servers' ones. Where there is no place for them, and
/// --insecure allows to do without, only servers without security can be reached.
class Credentials final : public crypto::CertificateValidator {
public:
    /// Both must outlive this; throws Failure.
    Credentials(Context& context, LogSink& log);

    [[nodiscard]] Checked<void> validate(const crypto::CertificateChain& chain,
                                         const crypto::ValidationContext& context) override;
    /// Null if there is none.
    [[nodiscard]] const channel::ApplicationIdentity* identity() const
    {
        return identity_ ? &*identity_ : nullptr;
    }
    [[nodiscard]] std::string application_uri() const;
    /// File of our certificate; empty if there is none.
    [[nodiscard]] std::string own_file() const { return pki_ ? pki_->own_file() : ""; }
    /// True if the last attempt to connect failed because of the certificate.
    [[nodiscard]] bool has_refused() const;
    /// True if it is worth another attempt; see ServerTrust.
    [[nodiscard]] bool reconsider();
    [[nodiscard]] Failure failure() const;

private:
    void open(LogSink& log);

    Context* context_;
    std::optional<Pki> pki_;
    std::optional<channel::ApplicationIdentity> identity_;
    std::optional<ServerTrust> trust_;
    /// The reason why there is no folder for certificates.
    std::optional<Failure> missing_;
    bool was_asked_{false};
};

/// The user to log in, from the options. Asks for a missing password on a terminal; throws Failure.
[[nodiscard]] client::UserIdentity user_of(Context& context);

/// A password that `user` gets: the first line of `file`, or what is typed twice on a terminal.
/// Throws Failure.
[[nodiscard]] crypto::Secret new_password(Context& context, const std::string& user,
                                          const std::string& file);

} // namespace busbar::tool
