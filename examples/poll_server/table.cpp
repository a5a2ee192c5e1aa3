#include "table.hpp"

namespace poll_server {

busbar::server::ModuleTable modules()
{
    return busbar::server::micro_modules();
}

busbar::model::AddressSpace address_space()
{
    return {}; // the nodes that the library was built with (BUSBAR_NAMESPACE0)
}

} // namespace poll_server
