#pragma once

#include <cstddef>

namespace busbar::test {

/// How often operator new was called in this program. Needs allocation_count.cpp in the test.
[[nodiscard]] std::size_t allocation_count();
/// How often operator delete got something.
[[nodiscard]] std::size_t free_count();
/// How often the calling thread called either of them.
[[nodiscard]] std::size_t calls_of_thread();
/// How many bytes it was asked for, all calls together.
[[nodiscard]] std::size_t allocated_bytes();

/// How many bytes it gave that were not given back, with what malloc adds to each.
[[nodiscard]] std::size_t held_bytes();
/// The most that these were since forget_peak().
[[nodiscard]] std::size_t peak_bytes();
void forget_peak();

} // namespace busbar::test
