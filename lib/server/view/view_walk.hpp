#pragma once

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

} // namespace busbar::server::detail
