#pragma once

#include <span>
#include <string>

#include <busbar/core/node_id.hpp>

namespace busbar::harness::detail {

/// The NodeId that a message's body begins with; null if there is none.
[[nodiscard]] NodeId encoding_of(std::span<const std::byte> body);
/// The name of the structure of namespace 0 with this binary encoding; the id as text if it is
/// none.
[[nodiscard]] std::string encoding_name(const NodeId& encoding_id);

} // namespace busbar::harness::detail
