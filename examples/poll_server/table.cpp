#include "table.hpp"

namespace poll_server {

busbar::server::ModuleTable modules()
{
    return busbar::server::micro_modules();
}

busbar::model::AddressSpace address_space()
{
    return {}; // those that the library was built with (BUSBAR_NAMESPACE0)
}

} // namespace poll_server
