#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/refusal.hpp>
#include <busbar/crypto/certificate_store.hpp>
#include <busbar/crypto/trust_list.hpp>

/// Converts a trust list from and to the bytes of a file (Part 12, 7.8.2.8, TrustListDataType).
namespace busbar::administration::detail {

/// All bits of TrustListMasks.
inline constexpr std::uint32_t all_lists = 15;

/// Encodes the lists in the masks; the others are empty.
[[nodiscard]] std::vector<std::byte> bytes_of(const crypto::TrustList& list, std::uint32_t masks);

/// Replaces those lists of `list` that `bytes` specify; sets `parts` accordingly.
/// Bad_InvalidArgument for other bytes, Bad_CertificateInvalid for elements that cannot be read.
[[nodiscard]] Checked<crypto::TrustList>
merge(std::span<const std::byte> bytes, crypto::TrustList list, crypto::TrustListParts& parts);

} // namespace busbar::administration::detail
