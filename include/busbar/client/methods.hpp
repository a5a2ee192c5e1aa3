#pragma once

#include <functional>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/method.hpp>

namespace busbar::client {

/// Calls methods (Part 4, 5.12.2). `done` gets a result for each. No call is made twice: only what
/// the server cannot have begun with is sent again. Calls of one request that is split may overtake
/// one another; who needs an order, makes one call after the other.
BUSBAR_API Operation call(Requester& requester, std::vector<CallMethodRequest> methods,
                          std::function<void(std::vector<CallMethodResult>)> done,
                          const ServiceOptions& options = {});

} // namespace busbar::client
