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
    [[nodiscard]] static detail::BorrowingRequest<CallRequest, CallMethodRequest>
    request(std::span<const CallMethodRequest> items)
    {
        return {items, {}, nullptr, {}};
    }
    static Array<CallMethodResult> results(CallResponse& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }
};

struct ExplainedCallService : CallService {
    using Outcome = ExplainedCall;

    static std::vector<ExplainedCall> results(CallResponse& response, std::size_t /*count*/)
    {
        std::vector<ExplainedCall> all;
        for (std::size_t i = 0; i < response.results.size(); ++i) {
            all.push_back({std::move(response.results[i]),
                           detail::additional_info_of(response.diagnostic_infos, i)});
        }
        return all;
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

Operation call_explained(Requester& requester, std::vector<CallMethodRequest> methods,
                         std::function<void(std::vector<ExplainedCall>)> done,
                         const ServiceOptions& options)
{
    return detail::run_batch(requester, ExplainedCallService{}, std::move(methods), std::move(done),
                             detail::asking_for_additional_info(options));
}

} // namespace busbar::client
