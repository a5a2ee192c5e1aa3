#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/types/common.hpp>

namespace busbar::server::detail {

/// Returns the bytes that are signed for a certificate and a nonce: the one followed by the other
/// (Part 4, 7.36).
[[nodiscard]] std::vector<std::byte> join(std::span<const std::byte> certificate,
                                          std::span<const std::byte> nonce);

/// True if the key of `signer` has signed the server's certificate and nonce by the policy (Part 4,
/// 5.7.3.2). Never with SecurityPolicy None.
[[nodiscard]] bool is_signed(const channel::ApplicationIdentity& server,
                             const crypto::SecurityPolicy& policy,
                             const crypto::Certificate& signer,
                             std::span<const std::byte> server_nonce,
                             const SignatureData& signature);

} // namespace busbar::server::detail
