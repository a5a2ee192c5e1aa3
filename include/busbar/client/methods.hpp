#pragma once

#include <functional>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/method.hpp>

namespace busbar::client {

/// Calls Methods (Part 4, 5.12.2). `done` gets a result for each. No call is made twice: only what
/// the server cannot have begun is sent again. Calls of one request that is split may overtake one
/// another; to keep an order, make one call after the other.
BUSBAR_API Operation call(Requester& requester, std::vector<CallMethodRequest> methods,
                          std::function<void(std::vector<CallMethodResult>)> done,
                          const ServiceOptions& options = {});

} // namespace busbar::client
