#pragma once

#include <optional>
#include <vector>

#include <busbar/crypto/own_certificate.hpp>

#include "own_certificate_files.hpp"

namespace busbar::crypto::detail {

/// What lies in the store, as far as it can be read.
struct OwnCertificateState {
    bool has_certificate{false};
    bool has_key{false};
    bool has_pending_key{false};
    std::vector<Certificate> certificates;
    std::optional<PrivateKey> key;
    std::optional<PrivateKey> pending_key;

    /// A new certificate was put in force; its key has not got its own name yet.
    [[nodiscard]] bool is_half_switched() const
    {
        return !certificates.empty() && pending_key &&
               pending_key->belongs_to(certificates.front()) &&
               !(key && key->belongs_to(certificates.front()));
    }
};

[[nodiscard]] OwnCertificateState read_state(const OwnCertificateFiles& files);

/// Of a half-switched state: gives the pending key the other's name. `state` is as if that had been
/// done, also if it fails.
[[nodiscard]] Stored<void> finish_switch(const OwnCertificateFiles& files,
                                         OwnCertificateState& state);

/// Before anything changes: makes the folders and finishes what a power cut left, so that the place
/// of the pending key is free.
[[nodiscard]] Checked<OwnCertificateState> prepare(const OwnCertificateFiles& files);

/// Replaces what is in force. The certificate's file decides: until it is replaced all is as it
/// was, and from then on its key lies in one of the two places. `state` is prepared.
[[nodiscard]] Checked<OwnCertificate> put_in_force(const OwnCertificateFiles& files,
                                                   const OwnCertificateState& state,
                                                   OwnCertificate own);

/// Lays the same down in `change`. What is in force is kept aside at once.
[[nodiscard]] Checked<void> stage(const OwnCertificateFiles& files,
                                  const OwnCertificateState& state, const OwnCertificate& own,
                                  FileTransaction& change);

} // namespace busbar::crypto::detail
