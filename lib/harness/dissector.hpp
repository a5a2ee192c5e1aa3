#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <busbar/harness/link.hpp>

#include "channel/frame.hpp"

namespace busbar::harness::detail {

/// One chunk, or message of the connection protocol, as it was sent.
struct DissectedFrame {
    std::vector<std::byte> bytes;
    channel::detail::MessageType type{channel::detail::MessageType::HEL};
    /// "MSG", ...; empty for bytes that are no frame.
    std::string_view type_name;
    /// Of a MSG that can be read: the structure's; else empty. The same for all of its chunks.
    std::string_view structure_name;
    bool is_first{true};
    bool is_last{true};
    /// Of a channel with policy None, so that its fields may be changed.
    bool is_plain{false};

    /// Of OPN, MSG and CLO that are plain: where SequenceNumber and RequestId stand.
    [[nodiscard]] std::optional<std::size_t> sequence_offset() const;
};

/// Cuts what both sides of one connection send into frames and reads as much of them as anybody on
/// the way can. Bytes that are no frames come out as they are.
class Dissector {
public:
    /// Takes what `from` has sent; take() gives the frames that it completes.
    void feed(Side from, std::span<const std::byte> bytes);
    [[nodiscard]] std::optional<DissectedFrame> take(Side from);

private:
    /// Past it what is collected is no frame that this library sends.
    static constexpr std::uint32_t max_frame_size = 16U << 20U;

    struct Stream {
        std::vector<std::byte> bytes;
        bool is_broken{false};
        bool is_in_message{false};
        std::string_view structure_name;
    };
    void describe(Stream& stream, DissectedFrame& frame);

    Stream streams_[2];
    bool is_plain_{false};
};

} // namespace busbar::harness::detail
