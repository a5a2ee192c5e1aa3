#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <busbar/net/client_loop.hpp>

namespace busbar::bench {

/// A subscription of which half of the items change in every scan of the PLC.
struct SubscribeOptions {
    std::vector<std::size_t> item_counts;
    /// NodeIds with "{}" where the number goes: Int16 that grow by one each scan, and any that
    /// stand still.
    std::string moving{"ns=2;s=Moving{}"};
    std::string still{"ns=2;s=Still{}"};
    double publishing_ms{200};
    double sampling_ms{200};
    std::uint32_t queue_size{1};
    double seconds{10};
    /// How long it runs before that counts.
    double warm_up_seconds{2};
    /// Whose processor time and memory are read; 0 for nobody's.
    int server_pid{0};
};

/// What a client saw of one subscription.
struct SubscribeRow {
    std::size_t items{0};
    std::size_t round{0};
    std::size_t publishes{0};
    double mean_interval_ms{0};
    double worst_interval_ms{0};
    double notifications_per_second{0};
    /// Of the server process, in percent of one core; and its resident memory.
    double cpu_percent{0};
    double resident_mb{0};
    /// NotificationMessages that were missed or came twice, and values that went back or stood
    /// still: all have to be 0.
    std::size_t messages_lost{0};
    std::size_t values_wrong{0};
    /// How far one value is from the one before it, at least and at most; in scans.
    std::uint16_t smallest_step{0};
    std::uint16_t largest_step{0};
};

/// Runs on a client that is ready, until the time is over.
[[nodiscard]] Result<SubscribeRow> subscribe(net::ClientLoop& loop, const SubscribeOptions& options,
                                             std::size_t items);

} // namespace busbar::bench
