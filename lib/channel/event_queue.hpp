#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <busbar/channel/channel_types.hpp>

namespace busbar::channel::detail {

/// Events that wait to be taken. There are one or two, so this allocates once in a channel's life.
class PendingEvents {
public:
    [[nodiscard]] bool empty() const { return next_ == events_.size(); }
    void push(ChannelEvent event) { events_.push_back(std::move(event)); }
    /// Adds the last event of a channel.
    void push_closed(StatusCode status, std::string reason)
    {
        push({ChannelEvent::Kind::Closed, 0, {}, status, std::move(reason)});
    }
    [[nodiscard]] std::optional<ChannelEvent> pop()
    {
        if (empty()) {
            return std::nullopt;
        }
        std::optional<ChannelEvent> event{std::move(events_[next_])};
        ++next_;
        if (empty()) {
            events_.clear();
            next_ = 0;
        }
        return event;
    }

private:
    std::vector<ChannelEvent> events_;
    std::size_t next_{0};
};

} // namespace busbar::channel::detail
