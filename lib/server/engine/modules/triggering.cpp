#include <array>

#include <busbar/server/modules.hpp>
#include <busbar/types/monitored_item.hpp>

#include "server/engine/run_service.hpp"
#include "server/subscription/monitored_item_services.hpp"

namespace busbar::server {

namespace detail {

namespace {

constexpr std::array triggering_rows{
    operation<SetTriggeringRequest, make_set_triggering, &Core::subscriptions>(Need::Activated),
};

} // namespace

} // namespace detail

constinit const Module modules::triggering{
    "triggering", [](detail::Core& core) { core.services.add(detail::triggering_rows); }};

} // namespace busbar::server
