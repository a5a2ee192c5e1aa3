#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate.hpp>

#include "own_certificate_state.hpp"

/// What an own certificate has to be, and what is said if it is not.
namespace busbar::crypto::detail {

[[nodiscard]] Refusal own_certificate_refusal(StatusCode status, std::string found,
                                              std::string remedy);
/// The same, about a certificate.
[[nodiscard]] Refusal own_certificate_refusal(const Certificate& certificate, StatusCode status,
                                              std::string found, std::string remedy);
/// What lies in the store cannot be used.
[[nodiscard]] Refusal broken(std::string found);
[[nodiscard]] Refusal unwritable(const std::string& file);

/// Key size, ApplicationUri (Part 6, 6.2.2; not looked at if empty) and whether it fits in the
/// store. `chain` is not empty.
[[nodiscard]] std::optional<Refusal> check_certificates(const CertificateChain& chain,
                                                        std::string_view application_uri);
/// Whether certificate and key are there, can be read and belong together.
[[nodiscard]] std::optional<Refusal> check_files(const OwnCertificateFiles& files,
                                                 const OwnCertificateState& state);

} // namespace busbar::crypto::detail
