#pragma once

#include <busbar/model/address_space.hpp>

namespace busbar::administration::detail {

/// Gives Authorities::FiveLevels to the nodes that namespace 0 and the administration have. After
/// all of them were added.
void give_authorities(model::AddressSpace& space);

} // namespace busbar::administration::detail
