#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/file_transaction.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/refusal.hpp>
#include <busbar/core/storage.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/private_key.hpp>
#include <busbar/crypto/self_signed.hpp>

namespace busbar::crypto {

/// The certificate of this application, followed by those that signed it, and its private key.
struct OwnCertificate {
    CertificateChain certificates;
    PrivateKey key;
};

/// The content of a certificate that the application creates for itself or requests from a CA.
struct OwnCertificateSettings {
    /// `valid_from` is ignored: it is the time of creation less a day, since clocks differ.
    /// `valid_days` count from the time of creation.
    CertificateSubject subject;
    /// 2048 to 4096.
    std::uint32_t key_bits{2048};
};

/// A certificate request and the key that was made for it.
struct SigningRequest {
    /// DER.
    std::vector<std::byte> request;
    /// Nothing if the request is for the present key.
    std::optional<PrivateKey> new_key;
};

/// Keeps an application's certificate and key (layout of Part 12, F.1) in a Storage:
///
///     own/certs/own.der         the certificate, followed by those that signed it, as on the wire
///     own/private/own.pem       its key, readable by its owner only
///     own/private/pending.pem   a key that waits for its certificate
///     own/replaced/             replaced files, by thumbprint; nothing here is ever deleted
///
/// No certificate or key, except a pending key, is overwritten before it is in own/replaced too.
/// After a power failure at any moment either the old certificate with the old key is in force, or
/// the new one with the new key: own.der is replaced in one step, which decides; the key is own.pem
/// or pending.pem, whichever belongs to it. The next call finishes what was begun.
///
/// Files that cannot be read or do not fit together are refused and left as they are. Refusals name
/// the file, what was found and what was expected; they never contain a part of a key.
///
/// Files that others put there may be PEM or DER; keys with a passphrase must be installed. One
/// process, one thread at a time. All functions block on the storage; generating a key takes
/// seconds.
class BUSBAR_API OwnCertificateStore {
public:
    /// The key of a request: a new key pair, or that of the certificate in force.
    enum class RequestKey : std::uint8_t { New, Present };

    /// The store is the root of `storage`, which must outlive this object, as must `log`. If `log`
    /// is not null, it gets CertificateUpdated for every certificate that a member puts in force
    /// itself.
    explicit OwnCertificateStore(Storage& storage, LogSink* log = nullptr);

    /// Returns the certificate and key in force; nothing if neither exists. Refused if the
    /// certificate does not name `application_uri` (Part 6, 6.2.2), unless that is empty.
    [[nodiscard]] Checked<std::optional<OwnCertificate>>
    load(std::string_view application_uri = {}) const;
    /// Loads likewise; creates a self-signed certificate if there is none, with the pending key if
    /// there is one.
    [[nodiscard]] Checked<OwnCertificate> load_or_create(const OwnCertificateSettings& settings,
                                                         DateTime now) const;
    /// Creates a new key and a new self-signed certificate and replaces the present ones, in
    /// whatever state these are. A pending key is discarded (Part 12, 7.10.10). Peers have to trust
    /// the new certificate.
    [[nodiscard]] Checked<OwnCertificate> regenerate(const OwnCertificateSettings& settings,
                                                     DateTime now) const;

    /// Creates a certificate request in DER. A new key becomes the pending one, replacing an
    /// earlier one (Part 12, 7.10.10), and survives restarts.
    [[nodiscard]] Checked<std::vector<std::byte>>
    create_signing_request(const OwnCertificateSettings& settings, RequestKey key) const;
    // The same in two steps, the first of which takes seconds.
    /// Creates a request. Changes nothing except what prepare() of the other members does.
    [[nodiscard]] Checked<SigningRequest>
    make_signing_request(const OwnCertificateSettings& settings, RequestKey key) const;
    /// Makes `key` the pending one, replacing an earlier one; it survives restarts.
    [[nodiscard]] Checked<void> keep_request_key(const PrivateKey& key) const;
    /// Puts a certificate that a CA issued in force: PEM or DER, with the certificates that signed
    /// it in any order. Refused if no certificate belongs to the pending or the present key, or if
    /// the one that does names another ApplicationUri. Trust and time are not checked.
    [[nodiscard]] Checked<OwnCertificate> take_in(std::span<const std::byte> certificates,
                                                  std::string_view application_uri) const;
    /// Puts a certificate and a key from elsewhere in force: read_pkcs12, or read_certificates and
    /// PrivateKey::parse. Refused under the same conditions. A pending key is discarded.
    [[nodiscard]] Checked<OwnCertificate> install(const OwnCertificate& own,
                                                  std::string_view application_uri) const;

    // The same in two steps, as part of a transaction on the same storage.

    /// Returns what take_in would put in force. Changes nothing except what prepare() of the other
    /// members does.
    [[nodiscard]] Checked<OwnCertificate> match(std::span<const std::byte> certificates,
                                                std::string_view application_uri) const;
    /// Adds to `change` the steps that put `own`, with its leaf first, in force: load() returns it
    /// after the commit. Refused as install() does.
    [[nodiscard]] Checked<void> stage(const OwnCertificate& own, std::string_view application_uri,
                                      FileTransaction& change) const;

private:
    [[nodiscard]] Checked<OwnCertificate> told(Checked<OwnCertificate> own,
                                               std::string_view what) const;

    Storage* storage_;
    LogSink* log_;
};

/// Reads the certificates of a PEM file, or concatenated DER, in their order: at most
/// max_chain_length, of max_chain_size together.
[[nodiscard]] BUSBAR_API Checked<std::vector<Certificate>>
read_certificates(std::span<const std::byte> contents);

} // namespace busbar::crypto
