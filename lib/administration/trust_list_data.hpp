#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/trust_list.hpp>

/// A trust list as the bytes of a file (Part 12, 7.8.2.8, TrustListDataType).
namespace busbar::administration::detail {

/// TrustListMasks.
inline constexpr std::uint32_t all_lists = 15;

/// The lists that the masks name; others are empty.
[[nodiscard]] std::vector<std::byte> bytes_of(const crypto::TrustList& list, std::uint32_t masks);

/// `list` with those lists that `bytes` name instead of its own; `parts` gets which they are.
/// Bad_InvalidArgument for other bytes, Bad_CertificateInvalid for what cannot be read in them.
[[nodiscard]] Checked<crypto::TrustList>
merge(std::span<const std::byte> bytes, crypto::TrustList list, crypto::TrustListParts& parts);

} // namespace busbar::administration::detail
