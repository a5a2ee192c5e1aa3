#pragma once

#include <cstddef>
#include <optional>

#include "view_context.hpp"
#include "view_part.hpp"

namespace busbar::server::detail {

/// Returns where a Browse of this node begins, or why it cannot. `view` is the View that it is made
/// in, or no_node.
[[nodiscard]] Result<BrowseState> begin_browse(ViewContext& context,
                                               const BrowseDescription& description,
                                               model::NodeIndex view, std::uint32_t max_references);

/// Reduces `result` to the reason of the failure.
void take_back(ViewContext& context, BrowseResult& result, StatusCode status);

/// Adds references to `result` from the position of `state` on, with a continuation point if the
/// client must ask for more. False if the context's turn ends before that; it must then be called
/// again with the same arguments. The node must exist, with the references it had when the state
/// was created.
[[nodiscard]] bool continue_browse(ViewContext& context, BrowseState& state, BrowseResult& result);

/// The place within a node where a turn ended.
struct BrowsePlace {
    /// Notified when the node's references have moved, which makes the position invalid.
    struct Watch final : model::NodeWatch {
        void node_changed(model::NodeIndex, bool) override { is_lost = true; }

        bool is_lost{false};
    };

    std::optional<BrowseState> state;
    Watch watch;
};

/// The place up to which results have texts of their own: all results before this one, and its
/// references before this one.
struct BrowseKept {
    std::size_t result{0};
    std::size_t references{0};
};

/// A Browse (Part 4, 5.9.2) that continues where its turn ended, within a node as well.
class BrowseWork {
public:
    /// Returns an error of the whole request, if there is one. Call it first, once.
    [[nodiscard]] StatusCode begin(ViewContext& context, const BrowseRequest& request,
                                   BrowseResponse& response);
    /// Returns true once the response is complete; false if the turn ends before.
    [[nodiscard]] bool go_on(ViewContext& context, const BrowseRequest& request,
                             BrowseResponse& response);
    /// Undoes its changes of the session's continuation points.
    void undo(Session& session) const;

private:
    [[nodiscard]] bool take_turn(ViewContext& context, const BrowseRequest& request,
                                 BrowseResponse& response);

    std::size_t next_{0};
    BrowseKept kept_;
    BrowsePlace place_;
    model::NodeIndex view_{model::no_node};
    std::uint32_t max_references_{0};
};

/// The same for BrowseNext (Part 4, 5.9.3).
class BrowseNextWork {
public:
    [[nodiscard]] StatusCode begin(ViewContext& context, const BrowseNextRequest& request,
                                   BrowseNextResponse& response);
    [[nodiscard]] bool go_on(ViewContext& context, const BrowseNextRequest& request,
                             BrowseNextResponse& response);
    void undo(Session& session);

private:
    [[nodiscard]] bool take_turn(ViewContext& context, const BrowseNextRequest& request,
                                 BrowseNextResponse& response);

    std::size_t next_{0};
    BrowseKept kept_;
    BrowsePlace place_;
    ViewPart::Points used_;
};

} // namespace busbar::server::detail
