#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include <busbar/client/requester.hpp>
#include <busbar/core/api.hpp>

namespace busbar::client {

/// Says how a service over a list of items is carried out. It is sent in as few requests as the
/// server's OperationLimits allow; a request that is refused for its size is sent again in halves.
struct ServiceOptions {
    /// Options of each request.
    RequestOptions request;
    /// Maximum number of items in one request, even if the server allows more.
    std::uint32_t max_items_per_request{10'000};
    /// Maximum number of requests of one operation that are under way.
    std::uint32_t max_parallel{4};

    ServiceOptions() = default;
    ServiceOptions(RequestOptions options) : request{options} {}
};

namespace detail {

class BUSBAR_API OperationState {
public:
    OperationState() = default;
    OperationState(const OperationState&) = delete;
    OperationState& operator=(const OperationState&) = delete;
    virtual ~OperationState() = default;
    virtual void cancel() = 0;
};

} // namespace detail

/// A service that is under way, in one request or more. Drop it if you do not want to cancel. Its
/// handler is called once, never from within the function that started it. Safe to keep after the
/// end of the operation and of the Requester.
class Operation {
public:
    Operation() = default;
    explicit Operation(std::weak_ptr<detail::OperationState> state) : state_{std::move(state)} {}

    /// Prevents the call of the handler and releases what the server keeps for the operation. Does
    /// nothing if the operation is over.
    void cancel()
    {
        if (const auto state = std::exchange(state_, {}).lock()) {
            state->cancel();
        }
    }
    [[nodiscard]] bool is_under_way() const { return !state_.expired(); }

private:
    std::weak_ptr<detail::OperationState> state_;
};

} // namespace busbar::client
