#include <busbar/core/detail/guarded.hpp>
#include <busbar/types/ids.hpp>

#include "browse_service.hpp"

namespace busbar::client {

namespace {

using detail::Batch;
using detail::BrowseNextService;
using detail::BrowseService;

/// Browses in rounds. A round is Browse for some nodes and BrowseNext until none of them has more.
///
/// A server may have few continuation points, and frees older ones for a new request (Part 4, 7.9).
/// Nodes that got none, or lost theirs, are browsed again in the next round, which is smaller.
class BrowseOperation final : public detail::OperationState,
                              public std::enable_shared_from_this<BrowseOperation> {
public:
    using Done = std::function<void(std::vector<BrowseResult>)>;

    BrowseOperation(Requester& requester, std::vector<BrowseDescription> nodes, Done done,
                    BrowseLimits limits, const ServiceOptions& options)
        : requester_{requester}, nodes_{std::move(nodes)}, results_(nodes_.size()),
          empty_answers_(nodes_.size()), done_{std::move(done)}, limits_{limits}, options_{options},
          window_{std::max<std::size_t>(nodes_.size(), 1)}
    {
        for (std::size_t i = nodes_.size(); i > 0; --i) {
            waiting_.push_back(i - 1);
        }
    }

    void begin_round()
    {
        const std::size_t count = std::min(window_, waiting_.size());
        round_.assign(waiting_.rbegin(), waiting_.rbegin() + static_cast<std::ptrdiff_t>(count));
        waiting_.resize(waiting_.size() - count);
        refused_.clear();
        std::vector<BrowseDescription> items;
        for (const std::size_t node : round_) {
            references_ -= results_[node].references.size();
            results_[node] = {};
            empty_answers_[node] = 0;
            items.push_back(nodes_[node]);
        }
        browse_ = Batch<BrowseService>::start(
            requester_, BrowseService{limits_.references_per_answer}, std::move(items),
            [self = shared_from_this()](std::vector<BrowseResult> results) {
                self->browsed(std::move(results));
            },
            options_);
    }

    /// Waits for requests under way, so that their continuation points can be released.
    void cancel() override
    {
        done_ = nullptr;
        is_cancelled_ = true;
        if (const auto batch = browse_.lock()) {
            batch->stop();
        }
        if (const auto batch = browse_next_.lock()) {
            batch->stop();
        }
    }

private:
    void browsed(std::vector<BrowseResult> results)
    {
        busbar::detail::Undo undo{[this] { give_up(); }};
        for (std::size_t i = 0; i < round_.size(); ++i) {
            const std::size_t node = round_[i];
            results_[node].status_code = results[i].status_code;
            if (!results[i].status_code.is_bad()) {
                take(node, std::move(results[i]));
            } else if (results[i].status_code.code() == status::Bad_NoContinuationPoints) {
                // Part 4, 5.9.2.4: others may release theirs.
                refused_.push_back(node);
            }
        }
        go_on();
        undo.keep();
    }
    /// There is no memory to continue: unfinished nodes have failed.
    void give_up()
    {
        if (is_finished_) {
            return; // it is the handler that has thrown
        }
        for (const auto* const nodes : {&round_, &waiting_}) {
            for (const std::size_t node : *nodes) {
                results_[node] = {};
                results_[node].status_code = status::Bad_OutOfMemory;
            }
        }
        for (ByteString& point : points_) {
            unused_.push_back(std::move(point));
        }
        busbar::detail::attempt([this] { release_unused(); });
        finish();
    }
    void finish()
    {
        is_finished_ = true;
        if (const Done done = std::exchange(done_, nullptr)) {
            done(std::move(results_));
        }
    }
    void continued(const std::vector<std::size_t>& asked, const std::vector<ByteString>& points,
                   std::vector<BrowseResult> results)
    {
        busbar::detail::Undo undo{[this] { give_up(); }};
        for (std::size_t i = 0; i < asked.size(); ++i) {
            const StatusCode status = results[i].status_code.code();
            if (status.is_bad()) {
                results_[asked[i]].status_code = status::Uncertain_NotAllNodesAvailable;
                if (status == status::Bad_RequestCancelledByClient) {
                    unused_.push_back(points[i]); // it was not sent
                } else if (status == status::Bad_ContinuationPointInvalid) {
                    refused_.push_back(asked[i]);
                }
            } else {
                take(asked[i], std::move(results[i]));
            }
        }
        go_on();
        undo.keep();
    }

    /// Adds a node's result, and keeps its continuation point to continue with or to release.
    void take(std::size_t node, BrowseResult from)
    {
        BrowseResult& to = results_[node];
        for (ReferenceDescription& reference : from.references) {
            if (is_full(node)) {
                break;
            }
            to.references.push_back(std::move(reference));
            ++references_;
        }
        empty_answers_[node] = from.references.empty() ? empty_answers_[node] + 1 : 0;
        if (from.continuation_point.empty()) {
            return;
        }
        if (is_cancelled_ || is_full(node) || empty_answers_[node] > limits_.max_empty_answers) {
            to.status_code = status::Uncertain_NotAllNodesAvailable;
            unused_.push_back(std::move(from.continuation_point));
            return;
        }
        more_.push_back(node);
        points_.push_back(std::move(from.continuation_point));
    }
    [[nodiscard]] bool is_full(std::size_t node) const
    {
        return results_[node].references.size() >= limits_.max_references_per_node ||
               references_ >= limits_.max_references;
    }

    void go_on()
    {
        release_unused();
        if (!more_.empty()) {
            return browse_next();
        }
        if (!is_cancelled_ && plan_next_round()) {
            return begin_round();
        }
        finish();
    }
    void browse_next()
    {
        auto asked = std::exchange(more_, {});
        auto points = std::exchange(points_, {});
        browse_next_ = Batch<BrowseNextService>::start(
            requester_, BrowseNextService{}, points,
            [self = shared_from_this(), asked = std::move(asked),
             points](std::vector<BrowseResult> results) {
                self->continued(asked, points, std::move(results));
            },
            options_);
    }
    /// Returns false if another try cannot help.
    [[nodiscard]] bool plan_next_round()
    {
        const std::size_t succeeded = round_.size() - refused_.size();
        lonely_tries_ = succeeded == 0 && round_.size() == 1 ? lonely_tries_ + 1 : 0;
        if (lonely_tries_ == max_lonely_tries) {
            refused_.clear();
            lonely_tries_ = 0;
        }
        is_careful_ = is_careful_ || !refused_.empty();
        window_ = refused_.empty() ? window_ * 2 : std::max<std::size_t>(succeeded, 1);
        // One request, so that nodes of the round do not take continuation points from each other.
        const std::size_t limit = requester_.server().operation_limits.max_nodes_per_browse;
        window_ = std::min(window_, is_careful_ && limit != 0 ? limit : nodes_.size());
        waiting_.insert(waiting_.end(), refused_.rbegin(), refused_.rend());
        return !waiting_.empty();
    }
    void release_unused()
    {
        if (!unused_.empty()) {
            static_cast<void>(detail::run_batch(
                requester_, BrowseNextService{true}, std::exchange(unused_, {}),
                [](const std::vector<BrowseResult>&) {}, options_));
        }
    }

    Requester& requester_;
    std::vector<BrowseDescription> nodes_;
    std::vector<BrowseResult> results_;
    std::vector<std::uint32_t> empty_answers_;
    Done done_;
    BrowseLimits limits_;
    ServiceOptions options_;
    std::size_t references_{0};
    bool is_cancelled_{false};
    bool is_finished_{false};

    // Indices of nodes_: not begun (the next one at the end), in this round, refused in it, with
    // more references.
    std::vector<std::size_t> waiting_;
    std::vector<std::size_t> round_;
    std::vector<std::size_t> refused_;
    std::vector<std::size_t> more_;
    /// Number of nodes in a round.
    std::size_t window_;
    bool is_careful_{false};
    /// Others in the session may take continuation points, but not for ever.
    static constexpr int max_lonely_tries = 3;
    int lonely_tries_{0};
    std::vector<ByteString> points_; // for more_
    std::vector<ByteString> unused_; // to be released
    std::weak_ptr<Batch<BrowseService>> browse_;
    std::weak_ptr<Batch<BrowseNextService>> browse_next_;
};

} // namespace

BrowseDescription children_of(NodeId node)
{
    constexpr std::uint32_t everything = 63; // BrowseResultMask All
    BrowseDescription description;
    description.node_id = std::move(node);
    description.browse_direction = BrowseDirection::Forward;
    description.reference_type_id = NodeId{0, id::HierarchicalReferences};
    description.include_subtypes = true;
    description.result_mask = everything;
    return description;
}

Operation browse(Requester& requester, std::vector<BrowseDescription> nodes,
                 std::function<void(std::vector<BrowseResult>)> done, BrowseLimits limits,
                 const ServiceOptions& options)
{
    const auto operation = std::make_shared<BrowseOperation>(requester, std::move(nodes),
                                                             std::move(done), limits, options);
    operation->begin_round();
    return Operation{operation};
}

} // namespace busbar::client
