#pragma once

#include <optional>
#include <string>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "context.hpp"

namespace busbar::tool {

/// Digits of a thumbprint that suffice to name a certificate if no other begins with them.
inline constexpr std::size_t min_thumbprint_digits = 4;

/// The folder of certificates: ours, those of servers that we trust, those that we do not.
class Pki {
public:
    /// Makes the folders that are missing, for their owner only; throws Failure. `log` must outlive
    /// this.
    Pki(const Options& options, LogSink& log);

    [[nodiscard]] const std::string& folder() const { return folder_; }
    [[nodiscard]] crypto::CertificateStore& store() { return store_; }
    /// Our certificate and key, created at the first use, which takes a second; throws Failure.
    [[nodiscard]] channel::ApplicationIdentity identity();
    /// Returns our own certificate; nothing if there is none yet.
    [[nodiscard]] std::optional<crypto::OwnCertificate> own();
    /// A new certificate and key instead of what is there.
    crypto::OwnCertificate replace_own(std::uint32_t valid_days);
    /// The ApplicationUri of our certificate.
    [[nodiscard]] static std::string application_uri();
    /// File of our certificate.
    [[nodiscard]] std::string own_file() const { return folder_ + "/own/certs/own.der"; }

private:
    [[nodiscard]] crypto::OwnCertificateSettings settings(std::uint32_t valid_days) const;

    std::string folder_;
    storage::FolderStorage storage_;
    crypto::OwnCertificateStore own_;
    crypto::CertificateStore store_;
};

/// The value, or the refusal as Failure.
template <typename T>
T expect(Checked<T> result, const std::string& what)
{
    if (!result) {
        throw Failure{result.error().status, what + ": " + result.error().found,
                      result.error().remedy};
    }
    if constexpr (!std::is_void_v<T>) {
        return *std::move(result);
    }
}

} // namespace busbar::tool
