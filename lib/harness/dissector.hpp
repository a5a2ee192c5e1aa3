#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/node_id.hpp>
#include <busbar/harness/link.hpp>

#include "channel/frame.hpp"
#include "chunks.hpp"

namespace busbar::harness::detail {

/// One chunk, or message of the connection protocol, as it was sent.
struct DissectedFrame {
    std::vector<std::byte> bytes;
    channel::detail::MessageType type{channel::detail::MessageType::HEL};
    /// "MSG", ...; empty for bytes that are not a frame.
    std::string_view type_name;
    /// The name of a readable MSG's structure; else empty. The same for all of its chunks.
    std::string_view structure_name;
    bool is_first{true};
    bool is_last{true};
    /// The channel has policy None, so that its fields may be changed.
    bool is_plain{false};
    /// The headers and the body of a secured chunk that a peer of this world has sent; else empty.
    std::vector<std::byte> opened{};

    /// The part of a MSG chunk that can be read: the body of its message. Empty if none can.
    [[nodiscard]] std::span<const std::byte> body() const;

    /// The offset of SequenceNumber and RequestId in a plain OPN, MSG or CLO.
    [[nodiscard]] std::optional<std::size_t> sequence_offset() const;
};

/// Splits the bytes of both sides of one connection into frames and reads as much of them as a
/// third party can. Bytes that are not frames are returned unchanged.
class Dissector {
public:
    /// `tap` may be null: then secured messages are not read. It must outlive the dissector.
    explicit Dissector(ChunkTap* tap = nullptr) : tap_{tap} {}

    /// Takes bytes that `from` has sent; take() returns the frames that they complete.
    void feed(Side from, std::span<const std::byte> bytes);
    [[nodiscard]] std::optional<DissectedFrame> take(Side from);

private:
    /// Larger input is not a frame of this library.
    static constexpr std::uint32_t max_frame_size = 16U << 20U;

    struct Stream {
        std::vector<std::byte> bytes;
        /// The number of those that were taken.
        std::size_t begin{0};
        bool is_broken{false};
        bool is_in_message{false};
        std::string_view structure_name;
    };
    void describe(Stream& stream, DissectedFrame& frame);

    ChunkTap* tap_;
    Stream streams_[2];
    bool is_plain_{false};
};

/// Returns the NodeId at the begin of a message's body; null if there is none.
[[nodiscard]] NodeId encoding_of(std::span<const std::byte> body);
/// Returns the name of the structure of namespace 0 with this binary encoding; the id as text if it
/// is unknown.
[[nodiscard]] std::string encoding_name(const NodeId& encoding_id);

} // namespace busbar::harness::detail
