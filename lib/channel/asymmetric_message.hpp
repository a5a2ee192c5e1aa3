#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/channel/channel_types.hpp>
#include <busbar/core/string.hpp>

#include "output_buffer.hpp"

namespace busbar::channel::detail {

/// The headers of an OpenSecureChannel message before its encrypted part (Part 6, 6.7.2.3).
/// Points into the message.
struct AsymmetricHeader {
    std::uint32_t channel_id{0};
    const crypto::SecurityPolicy* policy{nullptr};
    std::span<const std::byte> sender_certificate;
    std::span<const std::byte> receiver_thumbprint;
    std::size_t size{0}; // of all headers up to the sequence header
};

/// Returns Bad_SecurityPolicyRejected for an unknown policy, else Bad_DecodingError.
[[nodiscard]] Result<AsymmetricHeader> parse_asymmetric_header(std::span<const std::byte> message);

/// Sequence header and body, without padding and signature.
struct AsymmetricContent {
    std::uint32_t sequence_number{0};
    std::uint32_t request_id{0};
    std::vector<std::byte> body;
};

/// Decrypts with the receiver's key and verifies with the sender's certificate; neither is used
/// with policy None. Every failure is Bad_SecurityChecksFailed.
[[nodiscard]] Result<AsymmetricContent> open_asymmetric(std::span<const std::byte> message,
                                                        const AsymmetricHeader& header,
                                                        const crypto::PrivateKey* receiver,
                                                        const crypto::Certificate* sender);

/// The parts of an OPN message.
struct AsymmetricParts {
    std::uint32_t channel_id{0};
    const crypto::SecurityPolicy* policy{nullptr};
    const ApplicationIdentity* sender{nullptr};   // null with policy None
    const crypto::Certificate* receiver{nullptr}; // null with policy None
    std::uint32_t sequence_number{0};
    std::uint32_t request_id{0};
    std::span<const std::byte> body;
};

/// Signs and encrypts one OPN message of at most `max_size` bytes.
[[nodiscard]] Result<std::vector<std::byte>> make_asymmetric(const AsymmetricParts& parts,
                                                             std::size_t max_size);
/// Signs, encrypts and appends the message to `output`.
[[nodiscard]] Result<void> seal_asymmetric(OutputBuffer& output, const AsymmetricParts& parts,
                                           std::size_t max_size);

} // namespace busbar::channel::detail
