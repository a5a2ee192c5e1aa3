#pragma once

#include <busbar/harness/failing_memory.hpp>

/// The names of the harness's failing memory, for tests of layers below it too: it is in headers
/// alone. Needs failing_allocation.cpp in the test.
namespace busbar::test {

using harness::Counted;
using harness::fail_allocation;
using harness::fail_large_allocations;
using harness::has_allocation_failed;
using harness::live_allocations;
using harness::survives_counted;
using harness::Uncounted;

} // namespace busbar::test
