#pragma once

#include <busbar/controller/mapped_source.hpp>
#include <busbar/core/problem.hpp>

#include "mapped/mapped_model.hpp"

namespace busbar::bench {

/// Milliseconds of processor time.
struct MappedStartup {
    /// From the text of a project's file to a server whose labels are resolved and, if that is the
    /// mode, sampled.
    double mapped_ms{0};
    /// A server with the same nodes from the same files, and nothing else.
    double plain_ms{0};
};

/// The means of so many starts, in this thread: its PLC scans as soon as it is asked something, and
/// its time does not count.
[[nodiscard]] Configured<MappedStartup>
measure_mapped_startup(const MappedModel& model, controller::SamplingMode mode, int rounds);

} // namespace busbar::bench
