#pragma once

#include <busbar/core/clock.hpp>

namespace busbar::server {

/// The rate at which a server samples the values of its MonitoredItems.
struct SamplingState {
    /// The shortest revised interval of an item; zero if there is none.
    Duration smallest_revised_interval{0};
    /// The shortest actual time between two samples; zero before there were two.
    Duration smallest_actual_interval{0};
};

} // namespace busbar::server
