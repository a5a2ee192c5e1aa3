#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include <busbar/binary/reader.hpp>
#include <busbar/binary/writer.hpp>
#include <busbar/channel/chunk_hook.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/result.hpp>
#include <busbar/harness/wrong.hpp>

namespace busbar::harness::detail {

// Offsets in a MSG or CLO chunk (Part 6, 6.7.2.2 to 6.7.2.4).
inline constexpr std::size_t flag_offset = 3;
inline constexpr std::size_t size_offset = 4;
inline constexpr std::size_t channel_offset = 8;
inline constexpr std::size_t token_offset = 12;
inline constexpr std::size_t sequence_offset = 16;
inline constexpr std::size_t request_offset = 20;

/// The number at this place, which must be within the bytes.
[[nodiscard]] inline std::uint32_t number_at(std::span<const std::byte> bytes, std::size_t offset)
{
    binary::Reader reader{bytes.subspan(offset)};
    return reader.number<std::uint32_t>();
}

/// Writes it there.
inline void set_number(std::span<std::byte> bytes, std::size_t offset, std::uint32_t number)
{
    binary::SpanSink sink{bytes.subspan(offset, sizeof number)};
    binary::Writer writer{sink};
    writer.number(number);
}

/// Keeps what the peers of a world have sent on secured channels as it was before, so that faults
/// and traces can read it. Remembers the last chunks only: those that are on their way to the
/// network.
class ChunkTap final : public channel::ChunkHook {
public:
    void sealing(std::span<std::byte> chunk) override;
    void sealed(std::span<std::byte> chunk) override;

    /// Returns the headers and the body of a chunk that a peer of this world has secured; nothing
    /// for others. Once for each.
    [[nodiscard]] std::vector<std::byte> take(std::span<const std::byte> chunk);

private:
    static constexpr std::size_t max_entries = 256;

    struct Entry {
        std::vector<std::byte> plain;
        /// The last bytes of the chunk as it was sent, which are of a signature or its cipher.
        std::vector<std::byte> mark;
    };
    std::vector<std::byte> plain_;
    std::deque<Entry> entries_;
};

/// Makes the chunks of a scripted peer wrong as its script says, and passes them on.
class WrongChunks final : public channel::ChunkHook {
public:
    /// `next` must outlive it.
    explicit WrongChunks(channel::ChunkHook& next) : next_{&next} {}

    /// Sends a message, with `send` of a channel, as often and as wrong as it shall be. The first
    /// error of `send`.
    Result<void> send(const Wrong& wrong, std::span<const std::byte> body,
                      FunctionRef<Result<void>(FunctionRef<void(binary::Writer&)>)> send);

    /// The SecurityToken of the last chunk; 0 before there was one.
    [[nodiscard]] std::uint32_t token_id() const { return token_id_; }

    void sealing(std::span<std::byte> chunk) override;
    void sealed(std::span<std::byte> chunk) override;

private:
    channel::ChunkHook* next_;
    Wrong wrong_;
    bool is_first_{true};
    std::uint32_t token_id_{0};
};

} // namespace busbar::harness::detail
