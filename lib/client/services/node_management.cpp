#include <busbar/client/node_management.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

/// The four services differ in their structures only.
template <typename ItemType, typename OutcomeType, typename RequestType, typename ResponseType>
struct NodeManagementService {
    using Item = ItemType;
    using Outcome = OutcomeType;
    using Response = ResponseType;
    static constexpr bool is_repeatable = false;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_node_management;
    }
    [[nodiscard]] static detail::BorrowingRequest<RequestType, ItemType>
    request(std::span<const ItemType> items)
    {
        return {items, {}, nullptr, {}};
    }
    static Array<OutcomeType> results(ResponseType& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }
};

using AddNodesService =
    NodeManagementService<AddNodesItem, AddNodesResult, AddNodesRequest, AddNodesResponse>;
using AddReferencesService = NodeManagementService<AddReferencesItem, StatusCode,
                                                   AddReferencesRequest, AddReferencesResponse>;
using DeleteNodesService =
    NodeManagementService<DeleteNodesItem, StatusCode, DeleteNodesRequest, DeleteNodesResponse>;
using DeleteReferencesService =
    NodeManagementService<DeleteReferencesItem, StatusCode, DeleteReferencesRequest,
                          DeleteReferencesResponse>;

ServiceOptions in_order(ServiceOptions options)
{
    options.max_parallel = 1;
    return options;
}

} // namespace

Operation add_nodes(Requester& requester, std::vector<AddNodesItem> items,
                    std::function<void(std::vector<AddNodesResult>)> done,
                    const ServiceOptions& options)
{
    return detail::run_batch(requester, AddNodesService{}, std::move(items), std::move(done),
                             in_order(options));
}

Operation add_references(Requester& requester, std::vector<AddReferencesItem> items,
                         std::function<void(std::vector<StatusCode>)> done,
                         const ServiceOptions& options)
{
    return detail::run_batch(requester, AddReferencesService{}, std::move(items), std::move(done),
                             in_order(options));
}

Operation delete_nodes(Requester& requester, std::vector<DeleteNodesItem> items,
                       std::function<void(std::vector<StatusCode>)> done,
                       const ServiceOptions& options)
{
    return detail::run_batch(requester, DeleteNodesService{}, std::move(items), std::move(done),
                             in_order(options));
}

Operation delete_references(Requester& requester, std::vector<DeleteReferencesItem> items,
                            std::function<void(std::vector<StatusCode>)> done,
                            const ServiceOptions& options)
{
    return detail::run_batch(requester, DeleteReferencesService{}, std::move(items),
                             std::move(done), in_order(options));
}

} // namespace busbar::client
