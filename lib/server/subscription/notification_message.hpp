#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/result.hpp>

#include "ready_list.hpp"

/// NotificationMessages (Part 4, 7.26) as bytes, written straight from the queues.
namespace busbar::server::detail {

struct MessageLimits {
    /// Notifications; 0 for no limit but the other one.
    std::size_t notifications;
    /// What does not fit goes into the next message, but one Notification goes in for certain.
    std::size_t bytes;
    /// What the client takes at all: a Notification that alone has more is made smaller, see
    /// MonitoredItem::take_notification.
    std::size_t most_bytes;
};

/// Takes Notifications of the items that are ready: data first, unless `events_first`. It becomes
/// true if no place was left for all events, so that data which never ends does not keep them.
/// Takes what there is memory for and leaves the rest to its items; Bad_OutOfMemory for nothing.
[[nodiscard]] Result<std::vector<std::byte>>
write_notifications(std::uint32_t sequence_number, DateTime publish_time, ReadyList& data,
                    ReadyList& events, const MessageLimits& limits, bool& events_first);
/// A keep-alive: no Notification; `sequence_number` is that of the next message.
[[nodiscard]] std::vector<std::byte> write_keep_alive(std::uint32_t sequence_number,
                                                      DateTime publish_time);
[[nodiscard]] std::vector<std::byte> write_status_change(std::uint32_t sequence_number,
                                                         DateTime publish_time, StatusCode status);

} // namespace busbar::server::detail
