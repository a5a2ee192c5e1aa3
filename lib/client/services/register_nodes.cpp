#include <busbar/client/view.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

struct RegisterService {
    using Item = NodeId;
    using Outcome = Result<NodeId>;
    using Response = RegisterNodesResponse;
    /// A node that was registered twice would have to be unregistered twice.
    static constexpr bool is_repeatable = false;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_register_nodes;
    }
    [[nodiscard]] static detail::BorrowingRequest<RegisterNodesRequest, NodeId>
    request(std::span<const NodeId> items)
    {
        return {items, {}, nullptr, {}};
    }
    static Array<NodeId> results(RegisterNodesResponse& response, std::size_t /*count*/)
    {
        return std::move(response.registered_node_ids);
    }
};

struct UnregisterService {
    using Item = NodeId;
    using Outcome = StatusCode;
    using Response = UnregisterNodesResponse;
    static constexpr bool is_repeatable = true;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_register_nodes;
    }
    [[nodiscard]] static detail::BorrowingRequest<UnregisterNodesRequest, NodeId>
    request(std::span<const NodeId> items)
    {
        return {items, {}, nullptr, {}};
    }
    /// The response has no results (Part 4, 5.9.6.2).
    static Array<StatusCode> results(UnregisterNodesResponse& /*response*/, std::size_t count)
    {
        return Array<StatusCode>(count);
    }
};

} // namespace

Operation register_nodes(Requester& requester, std::vector<NodeId> nodes,
                         std::function<void(std::vector<Result<NodeId>>)> done,
                         const ServiceOptions& options)
{
    return detail::run_batch(requester, RegisterService{}, std::move(nodes), std::move(done),
                             options);
}

Operation unregister_nodes(Requester& requester, std::vector<NodeId> nodes,
                           std::function<void(std::vector<StatusCode>)> done,
                           const ServiceOptions& options)
{
    return detail::run_batch(requester, UnregisterService{}, std::move(nodes), std::move(done),
                             options);
}

} // namespace busbar::client
