#pragma once

#include <cstddef>

#include <busbar/core/function_ref.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/types/attribute.hpp>

namespace busbar::server::detail {

struct Core;

/// Looks which of the values that a client wrote with success belong to Properties that say what
/// their Variable's value means, EURange say, and lets the items of those Variables report the
/// change (Part 8, 5.2; Part 3, 8.57) and raises SemanticChangeEvents. Goes once through all items,
/// however many were written.
void announce_semantic_changes(Core& core, const WriteRequest& request,
                               FunctionRef<StatusCode(std::size_t)> result);

} // namespace busbar::server::detail
