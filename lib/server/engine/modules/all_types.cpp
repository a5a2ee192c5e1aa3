#include <busbar/server/modules.hpp>
#include <busbar/types/registry.hpp>

#include "server/engine/core.hpp"

namespace busbar::server {

constinit const Module modules::all_types{
    "all_types", [](detail::Core& core) { core.types.add(0, binary::namespace0_types()); }};

} // namespace busbar::server
