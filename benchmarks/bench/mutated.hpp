#pragma once

#include <cstddef>
#include <vector>

#include "churn.hpp"
#include "own_controller.hpp"

namespace busbar::bench {

/// Sends `requests` Calls of administration whose encoded parameters are changed in a few places,
/// from a session of each role at a time, and Calls without changes between them, which open what
/// the others use. Returns earlier if the controller ends or lets nobody in. The rows are the roles
/// with the requests that had results, and that had a fault or no answer. The same seed makes the
/// same requests but for what the controller answers, such as handles.
[[nodiscard]] std::vector<ChurnRow> send_mutated(OwnController& controller, std::size_t requests,
                                                 unsigned seed);

} // namespace busbar::bench
