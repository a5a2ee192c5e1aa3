#pragma once

#include <span>
#include <string>

#include <busbar/core/node_id.hpp>

namespace busbar::harness::detail {

/// Returns the NodeId at the begin of a message's body; null if there is none.
[[nodiscard]] NodeId encoding_of(std::span<const std::byte> body);
/// Returns the name of the structure of namespace 0 with this binary encoding; the id as text if it
/// is unknown.
[[nodiscard]] std::string encoding_name(const NodeId& encoding_id);

} // namespace busbar::harness::detail
