#pragma once

#include <busbar/core/clock.hpp>

namespace busbar::server {

/// How fast a server samples the values of its MonitoredItems.
struct SamplingState {
    /// The shortest interval that an item was given; zero if there is none.
    Duration smallest_revised_interval{0};
    /// The shortest between two samples as they happened; zero before there were two.
    Duration smallest_actual_interval{0};
};

} // namespace busbar::server
