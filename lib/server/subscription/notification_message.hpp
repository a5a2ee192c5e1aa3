#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <busbar/core/date_time.hpp>
#include <busbar/core/result.hpp>

#include "ready_list.hpp"

/// Writes NotificationMessages (Part 4, 7.26) as bytes, directly from the queues.
namespace busbar::server::detail {

struct MessageLimits {
    /// Maximum number of Notifications; 0 if only the other limit applies.
    std::size_t notifications;
    /// Further Notifications go into the next message, but one is always included.
    std::size_t bytes;
    /// Maximum size that the client accepts: a single Notification that exceeds it is reduced, see
    /// MonitoredItem::take_notification.
    std::size_t most_bytes;
};

/// Takes Notifications of the items that are ready: data first, unless `events_first`. That becomes
/// true if there was no room for all events, so that endless data does not delay them. Takes as
/// many as there is memory for and leaves the rest to its items; Bad_OutOfMemory if there is none.
[[nodiscard]] Result<std::vector<std::byte>>
write_notifications(std::uint32_t sequence_number, DateTime publish_time, ReadyList& data,
                    ReadyList& events, const MessageLimits& limits, bool& events_first);
/// Writes a keep-alive, without Notifications; `sequence_number` is that of the next message.
[[nodiscard]] std::vector<std::byte> write_keep_alive(std::uint32_t sequence_number,
                                                      DateTime publish_time);
[[nodiscard]] std::vector<std::byte> write_status_change(std::uint32_t sequence_number,
                                                         DateTime publish_time, StatusCode status);

} // namespace busbar::server::detail
