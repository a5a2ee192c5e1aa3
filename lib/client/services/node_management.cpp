#include <busbar/client/node_management.hpp>

#include "batch.hpp"

namespace busbar::client {

namespace {

/// The four services differ in their structures only.
template <typename ItemType, typename OutcomeType, typename RequestType, typename ResponseType,
          Array<ItemType> RequestType::*items_of>
struct NodeManagementService {
    using Item = ItemType;
    using Outcome = OutcomeType;
    using Response = ResponseType;
    static constexpr bool is_repeatable = false;

    static std::uint32_t limit(const ServerOperationLimits& limits)
    {
        return limits.max_nodes_per_node_management;
    }
    [[nodiscard]] static RequestType request(std::span<const ItemType> items)
    {
        RequestType request;
        request.*items_of = Array<ItemType>{items};
        return request;
    }
    static Array<OutcomeType> results(ResponseType& response, std::size_t /*count*/)
    {
        return std::move(response.results);
    }
};

using AddNodesService = NodeManagementService<AddNodesItem, AddNodesResult, AddNodesRequest,
                                              AddNodesResponse, &AddNodesRequest::nodes_to_add>;
using AddReferencesService =
    NodeManagementService<AddReferencesItem, StatusCode, AddReferencesRequest,
                          AddReferencesResponse, &AddReferencesRequest::references_to_add>;
using DeleteNodesService =
    NodeManagementService<DeleteNodesItem, StatusCode, DeleteNodesRequest, DeleteNodesResponse,
                          &DeleteNodesRequest::nodes_to_delete>;
using DeleteReferencesService =
    NodeManagementService<DeleteReferencesItem, StatusCode, DeleteReferencesRequest,
                          DeleteReferencesResponse, &DeleteReferencesRequest::references_to_delete>;

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
