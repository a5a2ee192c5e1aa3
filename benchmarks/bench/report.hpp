#pragma once

#include <vector>

#include "load.hpp"

namespace busbar::bench {

/// Prints the rows for people, or as one JSON object.
void print(const Options& options, const std::vector<Row>& rows);

} // namespace busbar::bench
