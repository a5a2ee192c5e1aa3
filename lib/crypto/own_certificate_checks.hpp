#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate.hpp>

#include "own_certificate_state.hpp"

/// The requirements for an own certificate, and the refusals if it does not meet them.
namespace busbar::crypto::detail {

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
