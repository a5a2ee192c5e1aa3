#pragma once

#include "view_context.hpp"
#include "view_part.hpp"

namespace busbar::server::detail {

/// Where a Browse of that node begins, or why it cannot. `view`: the View that it is made in, or
/// no_node.
[[nodiscard]] Result<BrowseState> begin_browse(ViewContext& context,
                                               const BrowseDescription& description,
                                               model::NodeIndex view, std::uint32_t max_references);

/// Leaves of `result` nothing but why it is not there.
void take_back(ViewContext& context, BrowseResult& result, StatusCode status);

/// Adds references to `result` from where `state` stands, with a continuation point if the client
/// has to ask for more. False if the context's turn is over before that; to be called again with
/// the same then. The node must be there, with the references it had when the state was made.
[[nodiscard]] bool continue_browse(ViewContext& context, BrowseState& state, BrowseResult& result);

} // namespace busbar::server::detail
