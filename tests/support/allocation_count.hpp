#pragma once

#include <cstddef>

namespace busbar::test {

/// How often operator new was called in this program. Needs allocation_count.cpp in the test.
[[nodiscard]] std::size_t allocation_count();

} // namespace busbar::test
