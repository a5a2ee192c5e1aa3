#pragma once

#include <optional>
#include <vector>

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

} // namespace busbar::crypto::detail
