#include <busbar/channel/spare_buffers.hpp>

#include <new>
#include <utility>

#include <busbar/channel/channel_types.hpp>
#include <busbar/crypto/secret.hpp>

#include "output_buffer.hpp"

namespace busbar::channel {

using detail::Block;

namespace {

/// A message does not stay in a buffer that is more than this many times as large.
constexpr std::size_t max_slack = 4;

/// Returns an empty block if there is no memory.
Block try_allocate(std::size_t size)
{
    std::unique_ptr<std::byte[]> bytes{new (std::nothrow) std::byte[size]};
    return bytes ? Block{std::move(bytes), size} : Block{};
}

/// Keeps the larger of both, unless it is too large to be kept.
void keep(std::vector<std::byte>& kept, std::vector<std::byte> other)
{
    if (other.capacity() > kept.capacity() && other.capacity() <= SpareBuffers::max_kept) {
        kept = std::move(other);
        kept.clear();
    }
}

} // namespace

SpareBuffers::SpareBuffers(std::size_t chunk_size)
    : chunk_size_{chunk_size != 0 ? chunk_size : TransportLimits{}.send_buffer_size},
      last_resort_{std::make_unique_for_overwrite<std::byte[]>(chunk_size_), chunk_size_}
{
}

SpareBuffers::~SpareBuffers() = default;

std::size_t SpareBuffers::kept() const
{
    return output_.size + last_resort_.size + input_.capacity() + message_.capacity();
}

Block SpareBuffers::lend(detail::OutputBuffer& to, std::size_t least, std::size_t wanted)
{
    if (holder_ != nullptr) {
        give_back(*holder_, holder_->leave_block());
    }
    if (output_.size >= least) {
        holder_ = &to;
        return std::exchange(output_, {});
    }
    Block block = try_allocate(wanted);
    if (block.size == 0 && last_resort_.size >= least) {
        return std::exchange(last_resort_, {});
    }
    if (block.size == 0) {
        block = {std::make_unique_for_overwrite<std::byte[]>(wanted), wanted};
    }
    output_ = {};
    holder_ = &to;
    return block;
}

void SpareBuffers::give_back(detail::OutputBuffer& from, Block block)
{
    if (holder_ == &from) {
        holder_ = nullptr;
    }
    if (block.size < chunk_size_ || block.size > max_kept) {
        return;
    }
    if (last_resort_.size == 0) {
        last_resort_ = std::move(block);
    } else if (holder_ == nullptr && block.size > output_.size) {
        output_ = std::move(block);
    }
}

std::vector<std::byte> SpareBuffers::take_input()
{
    return std::exchange(input_, {});
}

void SpareBuffers::give_back_input(std::vector<std::byte> input)
{
    keep(input_, std::move(input));
}

std::vector<std::byte> SpareBuffers::take_message(std::size_t size)
{
    return message_.capacity() / max_slack <= size ? std::exchange(message_, {})
                                                   : std::vector<std::byte>{};
}

std::vector<std::byte> SpareBuffers::fitted(std::vector<std::byte> message)
{
    if (message.capacity() / max_slack <= message.size()) {
        return message;
    }
    std::vector<std::byte> copy{message.begin(), message.end()};
    crypto::cleanse(message); // a secret should have one place
    give_back_message(std::move(message));
    return copy;
}

void SpareBuffers::give_back_message(std::vector<std::byte> message)
{
    keep(message_, std::move(message));
}

} // namespace busbar::channel
