#include <array>

#include <busbar/server/modules.hpp>
#include <busbar/types/subscription.hpp>

#include "server/engine/run_service.hpp"
#include "server/subscription/subscription_services.hpp"

namespace busbar::server {

namespace detail {

namespace {

constexpr std::array transfer_rows{
    function<TransferSubscriptionsRequest, TransferSubscriptionsResponse, &Core::subscriptions,
             transfer_subscriptions>(Need::Activated),
};

void add_transfer(Core& core)
{
    core.services.add(transfer_rows);
}

} // namespace

} // namespace detail

constinit const Module modules::transfer{"transfer", detail::add_transfer};

} // namespace busbar::server
