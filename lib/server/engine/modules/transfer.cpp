#include <array>

#include <busbar/server/modules.hpp>
#include <busbar/types/subscription.hpp>

#include "server/engine/run_service.hpp"
#include "server/subscription/subscription_services.hpp"

namespace busbar::server {

namespace detail {

namespace {

constexpr std::array transfer_rows{
    operation<TransferSubscriptionsRequest, make_transfer_subscriptions, &Core::subscriptions>(
        Need::Activated),
};

} // namespace

} // namespace detail

constinit const Module modules::transfer{
    "transfer", [](detail::Core& core) { core.services.add(detail::transfer_rows); }};

} // namespace busbar::server
