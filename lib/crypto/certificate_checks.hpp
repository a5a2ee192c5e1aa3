#pragma once

#include <busbar/crypto/certificate_validator.hpp>

/// The steps of Part 4, 6.1.3, table 100, one by one. Each gives the table's status or Good.
namespace busbar::crypto::detail {

[[nodiscard]] StatusCode check_structure(const Certificate& leaf);
/// Key size and signature algorithm of the leaf.
[[nodiscard]] StatusCode check_policy(const Certificate& leaf, const SecurityPolicy* policy);
/// Of an issuer: only that it is not weaker than the policy allows.
[[nodiscard]] StatusCode check_issuer_policy(const Certificate& issuer,
                                             const SecurityPolicy* policy);
[[nodiscard]] bool is_valid_at(const Certificate& certificate, DateTime time);
[[nodiscard]] StatusCode check_host_name(const Certificate& leaf, std::string_view host_name);
[[nodiscard]] StatusCode check_application_uri(const Certificate& leaf, std::string_view uri);
[[nodiscard]] StatusCode check_usage(const Certificate& leaf);

} // namespace busbar::crypto::detail
