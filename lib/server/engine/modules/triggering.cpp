#include <array>

#include <busbar/server/modules.hpp>
#include <busbar/types/monitored_item.hpp>

#include "server/engine/run_service.hpp"
#include "server/subscription/monitored_item_services.hpp"

namespace busbar::server {

namespace detail {

namespace {

constexpr std::array triggering_rows{
    function<SetTriggeringRequest, SetTriggeringResponse, &Core::subscriptions, set_triggering>(
        Need::Activated),
};

} // namespace

} // namespace detail

constinit const Module modules::triggering{
    "triggering", [](detail::Core& core) { core.services.add(detail::triggering_rows); }};

} // namespace busbar::server
