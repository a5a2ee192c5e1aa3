#pragma once

#include <vector>

#include "churn.hpp"
#include "hostile.hpp"
#include "load.hpp"

namespace busbar::bench {

/// Prints the rows for people, or as one JSON object.
void print(const Options& options, const std::vector<Row>& rows);
void print(const Options& options, const std::vector<SubscribeRow>& rows);
void print(const Options& options, const HostileOptions& hostile,
           const std::vector<HostileRow>& rows);
/// Prints what was done to the controller, and what was wrong if anything was.
void print(const ChurnReport& report);

} // namespace busbar::bench
