#pragma once

#include <vector>

#include "hostile.hpp"
#include "load.hpp"

namespace busbar::bench {

/// Prints the rows for people, or as one JSON object.
void print(const Options& options, const std::vector<Row>& rows);
void print(const Options& options, const std::vector<SubscribeRow>& rows);
void print(const Options& options, const HostileOptions& hostile,
           const std::vector<HostileRow>& rows);

} // namespace busbar::bench
