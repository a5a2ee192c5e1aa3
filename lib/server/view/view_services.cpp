#include "view_services.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <busbar/core/detail/guarded.hpp>

#include "browse_work.hpp"
#include "server/rights/nodes_ahead.hpp"
#include "server/session/session.hpp"
#include "server/session/sliced_operation.hpp"
#include "view_context.hpp"

namespace busbar::server::detail {

namespace {

ViewContext view_context(const ViewNeeds& needs, const ServiceContext& context)
{
    return {needs.space,      rights_of(*context.session, needs.space, needs.access),
            needs.limits,     needs.random,
            *context.session, needs.late_nodes};
}

/// A request that browses in turns.
template <typename Request, typename Response, typename Work>
class BrowseOperation final : public OperationOf<Request> {
public:
    explicit BrowseOperation(const ViewNeeds& needs) : needs_{needs} {}

    void start(ServiceContext& context) override
    {
        ViewContext view = view_context(needs_, context);
        view.memory = this->kept_memory();
        StatusCode status = work_.begin(view, this->request(), response_);
        if (status.is_good() && !this->charge(response_.results.size() * sizeof(BrowseResult))) {
            status = status::Bad_TooManyOperations;
        }
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
        ViewContext view = view_context(needs_, context);
        view.visits_left = visits_left_;
        view.references_left = references_left_;
        view.turn = context.peer.turn();
        busbar::detail::Undo undo{[&] { work_.undo(*context.session); }};
        const bool is_complete = work_.go_on(view, this->request(), response_);
        context.peer.turn() = view.turn;
        room_ += view.room;
        const std::ptrdiff_t added = std::max<std::ptrdiff_t>(room_ - paid_room_, 0);
        paid_room_ += added;
        visits_left_ = view.visits_left;
        references_left_ = view.references_left;
        undo.keep();
        if (is_complete) {
            this->respond_results(response_);
        } else if (!this->charge(static_cast<std::size_t>(added) * sizeof(ReferenceDescription) +
                                 view.text_bytes)) {
            this->fault(status::Bad_OutOfMemory);
        }
    }

private:
    [[nodiscard]] bool takes_aliases() const override { return true; }

    const ViewNeeds& needs_;
    Work work_;
    Response response_;
    std::size_t visits_left_{0};
    std::size_t references_left_{0};
    /// Number of references that there is room for, which was paid.
    std::ptrdiff_t room_{0};
    std::ptrdiff_t paid_room_{0};
};

/// TranslateBrowsePathsToNodeIds (Part 4, 5.9.4), path by path.
class TranslateOperation final : public SlicedOperation<TranslateBrowsePathsToNodeIdsRequest,
                                                        TranslateBrowsePathsToNodeIdsResponse> {
public:
    explicit TranslateOperation(const ViewNeeds& needs) : needs_{needs} {}

private:
    [[nodiscard]] bool takes_aliases() const override { return true; }
    [[nodiscard]] std::size_t size() const override { return request().browse_paths.size(); }
    [[nodiscard]] StatusCode begin(ServiceContext& context) override
    {
        const ViewContext view = view_context(needs_, context);
        visits_left_ = view.visits_left;
        references_left_ = view.references_left;
        return check_translate(view, request());
    }
    [[nodiscard]] StatusCode resume(ServiceContext& context) override
    {
        view_.emplace(view_context(needs_, context));
        view_->visits_left = visits_left_;
        view_->references_left = references_left_;
        return this->charge(std::exchange(owed_, 0)) ? StatusCode{} : status::Bad_OutOfMemory;
    }
    [[nodiscard]] std::optional<BrowsePathResult> work(std::size_t index, Turn& turn) override
    {
        turn.spend(units_of_path);
        fetch_ahead(needs_.space, request().browse_paths.span(), index,
                    [](const BrowsePath& path) -> const NodeId& { return path.starting_node; });
        view_->turn = turn;
        auto result = walk_.go_on(*view_, request().browse_paths[index]);
        turn = view_->turn;
        if (result) {
            walk_ = {};
        }
        return result;
    }
    void pause(ServiceContext&) override
    {
        owed_ = (references_left_ - view_->references_left) * sizeof(BrowsePathTarget) +
                view_->text_bytes + walk_.held() - std::min(paid_for_walk_, walk_.held());
        paid_for_walk_ = std::max(paid_for_walk_, walk_.held());
        visits_left_ = view_->visits_left;
        references_left_ = view_->references_left;
        view_.reset();
    }

    static constexpr std::size_t units_of_path = 100;

    const ViewNeeds& needs_;
    /// Valid during its turn.
    std::optional<ViewContext> view_;
    std::size_t visits_left_{0};
    std::size_t references_left_{0};
    /// The path in which the last turn ended.
    PathWalk walk_;
    std::size_t paid_for_walk_{0};
    /// Bytes of the results of the last turn.
    std::size_t owed_{0};
};

class RegisterOperation final : public OperationOf<RegisterNodesRequest> {
public:
    explicit RegisterOperation(const ViewNeeds& needs) : needs_{needs} {}

    void start(ServiceContext& context) override
    {
        ViewContext view = view_context(needs_, context);
        StatusCode status = RegisterWork::begin(view, request(), response_);
        if (status.is_good() && !charge(request().nodes_to_register.size() * sizeof(NodeId))) {
            status = status::Bad_TooManyOperations;
        }
        if (status.is_bad()) {
            return fault(status);
        }
        take_turn(context);
    }
    [[nodiscard]] bool wants_turn() const override { return !is_finished(); }
    void take_turn(ServiceContext& context) override
    {
        ViewContext view = view_context(needs_, context);
        view.turn = context.peer.turn();
        busbar::detail::Undo undo{[&] { RegisterWork::undo(*context.session, response_); }};
        const bool is_complete = RegisterWork::go_on(view, request(), response_);
        context.peer.turn() = view.turn;
        if (context.peer.has_thrown()) {
            return fault(status::Bad_InternalError);
        }
        undo.keep();
        if (is_complete) {
            respond<RegisterNodesResponse>(
                [&](binary::Writer& writer) { encode(writer, response_.registered_node_ids); });
        }
    }

private:
    const ViewNeeds& needs_;
    RegisterNodesResponse response_;
};

class UnregisterOperation final : public OperationOf<UnregisterNodesRequest> {
public:
    explicit UnregisterOperation(const ViewNeeds& needs) : needs_{needs} {}

    void start(ServiceContext& context) override
    {
        const StatusCode status = UnregisterWork::begin(view_context(needs_, context), request());
        if (status.is_bad()) {
            return fault(status);
        }
        take_turn(context);
    }
    [[nodiscard]] bool wants_turn() const override { return !is_finished(); }
    void take_turn(ServiceContext& context) override
    {
        ViewContext view = view_context(needs_, context);
        view.turn = context.peer.turn();
        const bool is_complete = work_.go_on(view, request());
        context.peer.turn() = view.turn;
        if (is_complete) {
            respond<UnregisterNodesResponse>([](binary::Writer&) {});
        }
    }

private:
    [[nodiscard]] bool takes_aliases() const override { return true; }

    const ViewNeeds& needs_;
    UnregisterWork work_;
};

} // namespace

std::unique_ptr<ServiceOperation> make_browse(const ViewNeeds& needs)
{
    return std::make_unique<BrowseOperation<BrowseRequest, BrowseResponse, BrowseWork>>(needs);
}

std::unique_ptr<ServiceOperation> make_browse_next(const ViewNeeds& needs)
{
    return std::make_unique<BrowseOperation<BrowseNextRequest, BrowseNextResponse, BrowseNextWork>>(
        needs);
}

std::unique_ptr<ServiceOperation> make_translate_browse_paths(const ViewNeeds& needs)
{
    return std::make_unique<TranslateOperation>(needs);
}

std::unique_ptr<ServiceOperation> make_register_nodes(const ViewNeeds& needs)
{
    return std::make_unique<RegisterOperation>(needs);
}

std::unique_ptr<ServiceOperation> make_unregister_nodes(const ViewNeeds& needs)
{
    return std::make_unique<UnregisterOperation>(needs);
}

} // namespace busbar::server::detail
