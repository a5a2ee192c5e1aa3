#include "node_management_services.hpp"

#include <optional>

#include <busbar/core/detail/guarded.hpp>

#include "node_changes.hpp"
#include "node_record.hpp"
#include "server/session/session.hpp"
#include "server/session/sliced_operation.hpp"

namespace busbar::server::detail {

namespace {

NodeManagementContext management_context(const NodeManagementNeeds& needs, const Session& session)
{
    return {needs.space,         rights_of(session, needs.space, needs.access),
            needs.config.limits, needs.client_nodes,
            needs.own_namespace, needs.config.application_uri};
}

AddNodesResult add_one(NodeManagementContext& context, const AddNodesItem& item)
{
    auto added = add_node(context, item);
    return added ? AddNodesResult{status::Good, *std::move(added)}
                 : AddNodesResult{added.error(), {}};
}

/// Deletes the node with all nodes that were added below it, and all references to these, whatever
/// deleteTargetReferences says: a server may delete more than requested (Part 4, 5.8.4.1), and here
/// every reference has a target. So there is no Uncertain_ReferenceNotDeleted.
StatusCode delete_one(NodeManagementContext& context, const DeleteNodesItem& item)
{
    const model::NodeIndex node = context.find(item.node_id);
    if (node == model::no_node) {
        return why_not_found(item.node_id);
    }
    StatusCode refusal = status::Good;
    context.space.for_each_below(node, [&](model::NodeIndex each) {
        refusal = context.rights.check_delete_node(each);
        return refusal.is_good();
    });
    if (refusal.is_bad()) {
        return refusal;
    }
    const auto removed = context.space.remove(node);
    return removed ? status::Good : removed.error();
}

/// Carries out a request item by item, and notifies clients of the changes after each turn.
template <typename Request, typename Response, auto Items, auto WorkOne>
class ManagementOperation final : public SlicedOperation<Request, Response> {
public:
    explicit ManagementOperation(const NodeManagementNeeds& needs) : needs_{needs} {}

private:
    using Result = typename SlicedOperation<Request, Response>::Result;

    [[nodiscard]] std::size_t size() const override { return (this->request().*Items).size(); }
    [[nodiscard]] StatusCode begin(ServiceContext& context) override
    {
        mark_ = context.mark;
        if (!needs_.config.has_node_management) {
            return status::Bad_ServiceUnsupported;
        }
        if (size() == 0) {
            return status::Bad_NothingToDo;
        }
        return size() > needs_.config.limits.operations.max_nodes_per_node_management
                   ? status::Bad_TooManyOperations
                   : status::Good;
    }
    [[nodiscard]] StatusCode resume(ServiceContext& context) override
    {
        management_.emplace(management_context(needs_, *context.session));
        if (visits_left_) {
            management_->visits_left = *visits_left_;
        }
        return status::Good;
    }
    [[nodiscard]] std::optional<Result> work(std::size_t index, Turn& turn) override
    {
        const std::size_t before = management_->visits_left;
        Result result = WorkOne(*management_, (this->request().*Items)[index]);
        turn.spend(units_of_change + before - management_->visits_left);
        busbar::detail::attempt([&] {
            record_change(needs_.log, *this->session(), mark_, (this->request().*Items)[index],
                          result);
        });
        return result;
    }
    void undo(const Response& response) override
    {
        if constexpr (std::is_same_v<Request, AddNodesRequest>) {
            for (const AddNodesResult& added : response.results) {
                const model::NodeIndex node = needs_.space.find(added.added_node_id);
                if (added.status_code.is_good() && node != model::no_node) {
                    static_cast<void>(needs_.space.remove(node));
                }
            }
        }
    }
    void pause(ServiceContext&) override
    {
        visits_left_ = management_->visits_left;
        management_.reset();
        needs_.observer.model_changed();
    }

    /// Cost of adding or removing a node or reference.
    static constexpr std::size_t units_of_change = 1'000;

    const NodeManagementNeeds& needs_;
    /// Valid during its turn.
    std::optional<NodeManagementContext> management_;
    RequestMark mark_;
    /// Empty before the first turn.
    std::optional<std::size_t> visits_left_;
};

} // namespace

std::unique_ptr<ServiceOperation> make_add_nodes(const NodeManagementNeeds& needs)
{
    return std::make_unique<ManagementOperation<AddNodesRequest, AddNodesResponse,
                                                &AddNodesRequest::nodes_to_add, add_one>>(needs);
}

std::unique_ptr<ServiceOperation> make_add_references(const NodeManagementNeeds& needs)
{
    return std::make_unique<
        ManagementOperation<AddReferencesRequest, AddReferencesResponse,
                            &AddReferencesRequest::references_to_add, add_reference>>(needs);
}

std::unique_ptr<ServiceOperation> make_delete_nodes(const NodeManagementNeeds& needs)
{
    return std::make_unique<ManagementOperation<DeleteNodesRequest, DeleteNodesResponse,
                                                &DeleteNodesRequest::nodes_to_delete, delete_one>>(
        needs);
}

std::unique_ptr<ServiceOperation> make_delete_references(const NodeManagementNeeds& needs)
{
    return std::make_unique<
        ManagementOperation<DeleteReferencesRequest, DeleteReferencesResponse,
                            &DeleteReferencesRequest::references_to_delete, delete_reference>>(
        needs);
}

} // namespace busbar::server::detail
