#pragma once

#include <cstddef>

#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// True if `node` is `top` or can be reached from it along forward references of `type` and its
/// subtypes. Looks upwards, where ways are few. `visits_left` goes down by the references that were
/// looked at; false once nothing is left of it.
[[nodiscard]] bool is_below(const model::AddressSpace& space, model::NodeIndex node,
                            model::NodeIndex top, model::NodeIndex type, std::size_t& visits_left);

} // namespace busbar::server::detail
