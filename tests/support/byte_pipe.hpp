#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <busbar/core/clock.hpp>

namespace busbar::test {

/// Everything that waits in an engine's output, taken out of it.
template <typename Engine>
[[nodiscard]] std::vector<std::byte> take_output(Engine& engine)
{
    const auto out = engine.output();
    std::vector<std::byte> bytes{out.begin(), out.end()};
    engine.consume(bytes.size());
    return bytes;
}

/// Moves everything that waits on one engine to the other in pieces of at most `piece` bytes and
/// lets `poll` run after each. True if there was anything.
template <typename From, typename To, typename Poll>
bool carry(From& from, To& to, TimePoint now, std::size_t piece, Poll poll)
{
    const auto bytes = take_output(from);
    std::span<const std::byte> rest{bytes};
    while (!rest.empty()) {
        const auto part = rest.first(std::min(piece, rest.size()));
        static_cast<void>(to.feed(part, now));
        poll();
        rest = rest.subspan(part.size());
    }
    return !bytes.empty();
}
template <typename From, typename To>
bool carry(From& from, To& to, TimePoint now)
{
    return carry(from, to, now, SIZE_MAX, [] {});
}

/// Feeds `bytes` in two parts, the first `cut` bytes long, and lets `poll` run after each.
template <typename To, typename Poll>
void feed_cut(To& to, std::span<const std::byte> bytes, std::size_t cut, TimePoint now, Poll poll)
{
    static_cast<void>(to.feed(bytes.first(cut), now));
    poll();
    static_cast<void>(to.feed(bytes.subspan(cut), now));
    poll();
}

} // namespace busbar::test
