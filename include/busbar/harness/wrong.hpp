#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <busbar/core/status_codes.hpp>

namespace busbar::harness {

/// Says how a message of a scripted peer departs from the protocol; what is not set is right.
/// Signatures are made afterwards: on a secured channel only what is said is wrong.
///
///     server.expect<ReadRequest>().reply(response).wrong({.sequence = Wrong::Sequence::Again});
struct Wrong {
    /// The sequence number of the message's first chunk.
    enum class Sequence : std::uint8_t {
        /// The next one.
        Right,
        /// That of the chunk before.
        Again,
        /// One is left out.
        Skipped
    };

    Sequence sequence{Sequence::Right};
    /// Sent in the header of the response.
    std::optional<std::uint32_t> request_handle{};
    /// Sent in the sequence header of each chunk.
    std::optional<std::uint32_t> request_id{};
    /// Sent in the message header of each chunk.
    std::optional<std::uint32_t> channel_id{};
    /// Sent in the security header of each chunk.
    std::optional<std::uint32_t> token_id{};
    /// The last byte of each chunk, which is of its signature or the signature's cipher. Without
    /// security it is the body's.
    bool signature{false};
    /// The last chunk's flag: 'C' says that more follows, 'A' that the message was given up (Part
    /// 6, 6.7.2.2). Any character.
    std::optional<char> chunk_flag{};
    /// Instead of the message a chunk that gives it up, with this status (Part 6, 6.7.3).
    std::optional<StatusCode> abort{};
    /// Number of bytes that its body lacks at the end.
    std::size_t cut_off{0};
    /// The number of times that it is sent, each time with a sequence number of its own; 0 is
    /// never.
    std::size_t copies{1};
};

} // namespace busbar::harness
