#include <busbar/server/modules.hpp>

#include "server/engine/core.hpp"

namespace busbar::server {

namespace detail {

namespace {

void add_definition_checks(Core& core)
{
    core.attribute_needs.definitions =
        std::make_unique<DataTypeChecks>(core.address_space, core.config.limits.decode);
}

} // namespace

} // namespace detail

constinit const Module modules::definition_checks{"definition_checks",
                                                  detail::add_definition_checks};

} // namespace busbar::server
