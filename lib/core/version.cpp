#include <busbar/core/version.hpp>

namespace busbar {

const char* version() noexcept
{
    return BUSBAR_VERSION;
}

} // namespace busbar
