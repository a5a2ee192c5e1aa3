#include <busbar/model/address_space.hpp>
#include <busbar/nodes/nodes.hpp>

namespace busbar::model {

AddressSpace::AddressSpace() : AddressSpace{namespace0_nodes()} {}

} // namespace busbar::model
