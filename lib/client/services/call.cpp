#include <busbar/client/methods.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

struct CallService {
    using Item = CallMethodRequest;
    using Outcome = CallMethodResult;
    using Response = CallResponse;
    static constexpr bool is_repeatable = false;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_method_call;
    }
    [[nodiscard]] static CallRequest request(std::span<const CallMethodRequest> items)
    {
        CallRequest request;
        request.methods_to_call = Array<CallMethodRequest>{items};
        return request;
    }
    static Array<CallMethodResult> results(CallResponse& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }
};

} // namespace

Operation call(Requester& requester, std::vector<CallMethodRequest> methods,
               std::function<void(std::vector<CallMethodResult>)> done,
               const ServiceOptions& options)
{
    return detail::run_batch(requester, CallService{}, std::move(methods), std::move(done),
                             options);
}

} // namespace busbar::client
