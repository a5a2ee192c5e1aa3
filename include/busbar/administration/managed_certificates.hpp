#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/own_certificate.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::administration {

/// The objects that ServerConfiguration manages (Part 12, 7.10): the server's own certificate, the
/// trust list of applications and that of users. All must outlive the Administration.
struct ManagedCertificates {
    [[no_unique_address]] NamedFields named_fields{};

    /// Required: the storage of all of them. The own certificate is that of an OwnCertificateStore
    /// at its root; a transaction keeps pending changes in its folder "transaction"
    /// (finish_changes).
    Storage* files{nullptr};
    /// Required: DefaultApplicationGroup; its root is that of `files`.
    crypto::CertificateStore* applications{nullptr};
    /// DefaultUserTokenGroup; null if there is none.
    crypto::CertificateStore* users{nullptr};
    /// The folder of `files` that is the root of `users`: "users".
    std::string users_folder{};
    /// Called on the server's thread when the server has another certificate, for code that uses
    /// the old one elsewhere, such as a registration with a discovery server. May be empty.
    std::function<void(const crypto::OwnCertificate&)> renewed{};
    /// Returns the configured content of certificates that the server creates itself on a client's
    /// request: names, all empty if none are configured, and hosts in addition to those that the
    /// certificate has. May be empty.
    std::function<crypto::CertificateSubject()> configured{};
    /// Returns whether the own certificate may be replaced now, called before DeleteCertificate and
    /// CreateSelfSignedCertificate; the problem goes to the client. False while other names are
    /// about to be configured. If empty, it may.
    std::function<Configured<void>()> may_replace_own{};
    /// Bits of generated keys: 2048 to 4096.
    std::uint32_t key_bits{2048};
    /// Maximum size of an encoded trust list, with all its lists together (MaxTrustListSize).
    std::size_t max_trust_list_size{4U << 20U};
};

/// Completes what ApplyChanges had decided when the power failed, and discards what it had not:
/// call it before anything reads the certificates in `files`. The problem says what cannot be
/// completed; a later call completes it.
[[nodiscard]] BUSBAR_API Configured<void> finish_changes(Storage& files);
/// Removes these files, and all files in these folders, in one step that a power failure makes
/// completely or not at all; finish_changes completes it. The problem names what cannot be read or
/// written.
[[nodiscard]] BUSBAR_API Configured<void> remove_files(Storage& files,
                                                       std::span<const std::string_view> names,
                                                       std::span<const std::string_view> folders);

} // namespace busbar::administration
