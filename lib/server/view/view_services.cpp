#include "view_services.hpp"

#include <algorithm>

#include "browse_work.hpp"
#include "server/engine/core.hpp"
#include "server/engine/link.hpp"
#include "server/session/session_rights.hpp"
#include "view_context.hpp"

namespace busbar::server::detail {

namespace {

ViewContext view_context(const ServiceContext& context)
{
    const Core& core = context.core;
    return {core.address_space, rights_of(context), core.limits(), *core.environment.random,
            *context.session};
}

/// A request that browses as long as its turns allow.
template <typename Request, typename Response, typename Work>
class BrowseOperation final : public OperationOf<Request> {
public:
    void start(ServiceContext& context) override
    {
        ViewContext view = view_context(context);
        const StatusCode status = work_.begin(view, this->request(), response_);
        visits_left_ = view.visits_left;
        references_left_ = view.references_left;
        if (status.is_bad()) {
            this->fault(status);
        } else {
            take_turn(context);
        }
    }
    [[nodiscard]] bool wants_turn() const override { return !this->is_finished(); }
    void take_turn(ServiceContext& context) override
    {
        ViewContext view = view_context(context);
        view.visits_left = visits_left_;
        view.references_left = references_left_;
        view.turn = context.link.turn();
        const bool is_complete = work_.go_on(view, this->request(), response_);
        context.link.turn() = view.turn;
        const std::size_t added =
            references_left_ - std::min(references_left_, view.references_left);
        visits_left_ = view.visits_left;
        references_left_ = view.references_left;
        if (is_complete) {
            this->template respond<Response>([this](binary::Writer& writer) {
                encode(writer, response_.results);
                encode(writer, response_.diagnostic_infos);
            });
        } else if (!this->charge(added * sizeof(ReferenceDescription))) {
            this->fault(status::Bad_OutOfMemory);
        }
    }

private:
    Work work_;
    Response response_;
    std::size_t visits_left_{0};
    std::size_t references_left_{0};
};

} // namespace

std::unique_ptr<Operation> make_browse()
{
    return std::make_unique<BrowseOperation<BrowseRequest, BrowseResponse, BrowseWork>>();
}

std::unique_ptr<Operation> make_browse_next()
{
    return std::make_unique<
        BrowseOperation<BrowseNextRequest, BrowseNextResponse, BrowseNextWork>>();
}

StatusCode translate_browse_paths(ServiceContext& context,
                                  const TranslateBrowsePathsToNodeIdsRequest& request,
                                  TranslateBrowsePathsToNodeIdsResponse& response)
{
    ViewContext view = view_context(context);
    return translate_browse_paths(view, request, response);
}

StatusCode register_nodes(ServiceContext& context, const RegisterNodesRequest& request,
                          RegisterNodesResponse& response)
{
    ViewContext view = view_context(context);
    return register_nodes(view, request, response);
}

StatusCode unregister_nodes(ServiceContext& context, const UnregisterNodesRequest& request,
                            UnregisterNodesResponse&)
{
    ViewContext view = view_context(context);
    return unregister_nodes(view, request);
}

} // namespace busbar::server::detail
