#include <algorithm>
#include <cstdint>

#include "support/channel_pair.hpp"

namespace framing_fuzz {

using namespace busbar;

namespace {

/// Feeds `input` in pieces of `piece` bytes and polls everything an owner would poll.
template <typename Channel>
void feed(Channel& channel, std::span<const std::byte> input, std::size_t piece, TimePoint now)
{
    while (!input.empty()) {
        const auto part = input.first(std::min(piece, input.size()));
        static_cast<void>(channel.feed(part, now));
        while (channel.next_event()) {
        }
        channel.consume(channel.output().size());
        input = input.subspan(part.size());
    }
    channel.handle_deadline(channel.next_deadline());
}

} // namespace

/// The first byte chooses the side and the size of the pieces; the rest is what a peer sends.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const auto input = std::as_bytes(std::span{data, size}).subspan(1);
    const std::size_t piece = data[0] < 0x40 ? 1 + data[0] % 32 : SIZE_MAX;
    test::ChannelPair pair;
    if (data[0] % 2 == 0) {
        feed(pair.server, input, piece, pair.now);
    } else {
        feed(pair.client, input, piece, pair.now);
    }
    return 0;
}

} // namespace framing_fuzz
