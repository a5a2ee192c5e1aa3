#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <busbar/binary/writer.hpp>
#include <busbar/channel/chunk_hook.hpp>
#include <busbar/core/function_ref.hpp>
#include <busbar/core/result.hpp>
#include <busbar/harness/wrong.hpp>

namespace busbar::harness::detail {

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
