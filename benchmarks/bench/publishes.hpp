#pragma once

#include <cstddef>

#include "load.hpp"

namespace busbar::bench {

/// Many Subscriptions of one item each, spread over sessions with a connection each.
struct PublishesOptions {
    std::size_t subscriptions{1'000};
    std::size_t sessions{20};
    double interval_ms{100};
};

/// What they cost the server and brought the clients.
struct Publishes {
    double seconds{0};
    /// NotificationMessages of all clients, without keep-alives.
    std::size_t messages{0};
    /// Messages that were missed or came twice; has to be 0.
    std::size_t lost{0};
    /// Of the server process, in percent of one core.
    double cpu_percent{0};
};

/// Runs for the load's seconds against its server; the item is the server's CurrentTime, which is
/// another at each sampling.
[[nodiscard]] Result<Publishes> measure_publishes(Load& load, const Options& options,
                                                  const PublishesOptions& publishes);

/// Prints a line for people, or a JSON object.
void print(const PublishesOptions& options, const Publishes& measured, bool json);

} // namespace busbar::bench
