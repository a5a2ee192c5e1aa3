#pragma once

#include <cstddef>

#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// True if `node` is `top` or can be reached from it along forward references of `type` and its
/// subtypes. Searches upwards, where there are few ways. `visits_left` is decremented for each
/// reference it looks at; false once it reaches zero.
[[nodiscard]] bool is_below(const model::AddressSpace& space, model::NodeIndex node,
                            model::NodeIndex top, model::NodeIndex type, std::size_t& visits_left);

} // namespace busbar::server::detail
