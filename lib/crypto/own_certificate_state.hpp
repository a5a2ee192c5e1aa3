#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate.hpp>
#include <busbar/crypto/own_certificate.hpp>

#include "own_certificate_files.hpp"

namespace busbar::crypto::detail {

/// The contents of the store, as far as they can be read.
struct OwnCertificateState {
    bool has_certificate{false};
    bool has_key{false};
    bool has_pending_key{false};
    std::vector<Certificate> certificates;
    std::optional<PrivateKey> key;
    std::optional<PrivateKey> pending_key;

    /// A new certificate is in force, but its key does not have its final name yet.
    [[nodiscard]] bool is_half_switched() const
    {
        return !certificates.empty() && pending_key &&
               pending_key->belongs_to(certificates.front()) &&
               !(key && key->belongs_to(certificates.front()));
    }
};

[[nodiscard]] OwnCertificateState read_state(const OwnCertificateFiles& files);

/// Completes a half-switched state: gives the pending key the other's name. `state` is as if that
/// had been done, even if it fails.
[[nodiscard]] Stored<void> finish_switch(const OwnCertificateFiles& files,
                                         OwnCertificateState& state);

/// Call it before any change: creates the folders and completes an interrupted change, so that the
/// place of the pending key is free.
[[nodiscard]] Checked<OwnCertificateState> prepare(const OwnCertificateFiles& files);

/// Replaces the certificate in force. Its file decides: until it is replaced nothing has changed,
/// and from then on its key is in one of the two places. `state` is prepared.
[[nodiscard]] Checked<OwnCertificate> put_in_force(const OwnCertificateFiles& files,
                                                   const OwnCertificateState& state,
                                                   OwnCertificate own);

/// Adds the same steps to `change`. Copies the certificate in force at once.
[[nodiscard]] Checked<void> stage(const OwnCertificateFiles& files,
                                  const OwnCertificateState& state, const OwnCertificate& own,
                                  FileTransaction& change);

[[nodiscard]] Refusal own_certificate_refusal(StatusCode status, std::string found,
                                              std::string remedy);
/// Returns the refusal of a certificate.
[[nodiscard]] Refusal own_certificate_refusal(const Certificate& certificate, StatusCode status,
                                              std::string found, std::string remedy);
/// Returns the refusal of unusable contents of the store.
[[nodiscard]] Refusal broken(std::string found);
[[nodiscard]] Refusal unwritable(const std::string& file);

/// Checks key size, ApplicationUri (Part 6, 6.2.2; ignored if empty) and whether it fits in the
/// store. `chain` is not empty.
[[nodiscard]] std::optional<Refusal> check_certificates(const CertificateChain& chain,
                                                        std::string_view application_uri);
/// Checks whether certificate and key exist, can be read and belong together.
[[nodiscard]] std::optional<Refusal> check_files(const OwnCertificateFiles& files,
                                                 const OwnCertificateState& state);

} // namespace busbar::crypto::detail
