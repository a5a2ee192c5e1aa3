#pragma once

#include <functional>
#include <string>
#include <vector>

#include <busbar/client/operation.hpp>
#include <busbar/core/api.hpp>
#include <busbar/types/method.hpp>

namespace busbar::client {

/// Calls Methods (Part 4, 5.12.2). `done` gets a result for each. No call is made twice: only calls
/// that the server cannot have begun are sent again. Calls of one request that is split may
/// overtake one another; to keep an order, make one call after the other.
BUSBAR_API Operation call(Requester& requester, std::vector<CallMethodRequest> methods,
                          std::function<void(std::vector<CallMethodResult>)> done,
                          const ServiceOptions& options = {});

/// A result with the DiagnosticInfo's additionalInfo: its subject and, from a Busbar server to an
/// administrator over an encrypted channel, the reason of a refusal. Empty if the server returns
/// none.
struct ExplainedCall : CallMethodResult {
    std::string additional_info;
};

/// Calls likewise, and requests the additionalInfo (Part 4, 7.12).
BUSBAR_API Operation call_explained(Requester& requester, std::vector<CallMethodRequest> methods,
                                    std::function<void(std::vector<ExplainedCall>)> done,
                                    const ServiceOptions& options = {});

} // namespace busbar::client
