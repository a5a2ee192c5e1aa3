#pragma once

#include <busbar/harness/seeded_random.hpp>

namespace busbar::test {

using harness::SeededRandom;

} // namespace busbar::test
