#pragma once

namespace busbar::bench {

/// The most that was resident since forget_peak(), in MB.
[[nodiscard]] double peak_megabytes();

/// Also gives back what is free, so that it does not count as there before.
void forget_peak();

} // namespace busbar::bench
