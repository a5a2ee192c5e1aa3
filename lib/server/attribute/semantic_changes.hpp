#pragma once

#include <cstddef>
#include <span>
#include <unordered_set>

#include <busbar/core/function_ref.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/types/attribute.hpp>

namespace busbar::server::detail {

/// Returns the Variables whose values have another meaning now: those with Properties, for example
/// EURange, that a client wrote successfully (Part 8, 5.2; Part 3, 8.57). `nodes` and `result` are
/// as for WriteObserver.
[[nodiscard]] std::unordered_set<NodeId>
find_semantic_changes(const model::AddressSpace& space, const WriteRequest& request,
                      std::span<const model::NodeHandle> nodes,
                      FunctionRef<StatusCode(std::size_t)> result);

} // namespace busbar::server::detail
