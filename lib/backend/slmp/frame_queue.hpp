#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <utility>
#include <vector>

namespace busbar::backend::detail {

/// Frames that wait to be sent. One is given out at a time, since over UDP it is a datagram.
class SlmpFrameQueue {
public:
    void push(std::vector<std::byte> frame) { frames_.push_back(std::move(frame)); }
    /// Returns what is left of the first frame; empty if there is none.
    [[nodiscard]] std::span<const std::byte> front() const
    {
        return frames_.empty() ? std::span<const std::byte>{}
                               : std::span{frames_.front()}.subspan(consumed_);
    }
    /// Removes bytes from front(), at most all of them.
    void consume(std::size_t size)
    {
        if (size < front().size()) {
            consumed_ += size;
        } else if (!frames_.empty()) {
            frames_.pop_front();
            consumed_ = 0;
        }
    }
    void clear()
    {
        frames_.clear();
        consumed_ = 0;
    }

private:
    std::deque<std::vector<std::byte>> frames_{};
    std::size_t consumed_{0};
};

} // namespace busbar::backend::detail
