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

/// What ServerConfiguration manages (Part 12, 7.10): the server's own certificate, the trust list
/// of applications and that of users. All must outlive the Administration.
struct ManagedCertificates {
    [[no_unique_address]] NamedFields named_fields{};

    /// Required: where all of it lies. The own certificate is that of an OwnCertificateStore at its
    /// root; a transaction keeps what is to come in its folder "transaction" (finish_changes).
    Storage* files{nullptr};
    /// Required: DefaultApplicationGroup; its root is that of `files`.
    crypto::CertificateStore* applications{nullptr};
    /// DefaultUserTokenGroup; null: there is none.
    crypto::CertificateStore* users{nullptr};
    /// The folder of `files` that is the root of `users`: "users".
    std::string users_folder{};
    /// Told on the server's thread when the server has another certificate: whoever uses the old
    /// one by other ways than the server's, such as a registration with a discovery server. May be
    /// empty.
    std::function<void(const crypto::OwnCertificate&)> renewed{};
    /// What somebody has configured that a certificate says which the server makes by itself, for
    /// clients who have it make one: names, all empty if nobody has, and hosts beside those that
    /// it has. May be empty.
    std::function<crypto::CertificateSubject()> configured{};
    /// Bits of keys that are made: 2048 to 4096.
    std::uint32_t key_bits{2048};
    /// Bytes of a trust list as it is sent and written, all its lists together (MaxTrustListSize).
    std::size_t max_trust_list_size{4U << 20U};
};

/// Finishes what ApplyChanges had decided when the power went, and forgets what it had not: to be
/// called before anything reads the certificates in `files`. The problem says what cannot be
/// finished; nothing has changed then that a later call does not finish.
[[nodiscard]] BUSBAR_API Configured<void> finish_changes(Storage& files);
/// Removes these files, and all files in these folders, in one step that a power cut does whole or
/// not at all; finish_changes goes on with it. The problem names what cannot be read or written.
[[nodiscard]] BUSBAR_API Configured<void> remove_files(Storage& files,
                                                       std::span<const std::string_view> names,
                                                       std::span<const std::string_view> folders);

} // namespace busbar::administration
