#include "built_in_methods.hpp"

#include <busbar/types/ids.hpp>

#include "server/subscription/subscription.hpp"
#include "server/subscription/subscription_services.hpp"
#include "server/subscription/subscription_table.hpp"

namespace busbar::server::detail {

namespace {

/// Returns the input of both Methods: the id of a Subscription.
std::uint32_t subscription_id(std::span<const Variant> inputs)
{
    return inputs.empty() ? 0 : inputs[0].value_or<std::uint32_t>(0);
}

CallResult call_get_monitored_items(const SubscriptionTable& all, const Session& session,
                                    std::uint32_t id, std::size_t& item_count)
{
    auto handles = get_monitored_items(all, session, id);
    if (!handles) {
        return CallResult{handles.error()};
    }
    item_count += handles->server_handles.size();
    CallResult result{status::Good};
    result.outputs.reserve(2);
    result.outputs.emplace_back(std::move(handles->server_handles));
    result.outputs.emplace_back(std::move(handles->client_handles));
    return result;
}

} // namespace

CallResult SubscriptionMethods::call(const NodeId& method, const ServiceContext& context,
                                     std::span<const Variant> inputs, std::size_t& item_count)
{
    const std::uint32_t subscription = subscription_id(inputs);
    if (method.is(id::Server_GetMonitoredItems)) {
        return call_get_monitored_items(all_, *context.session, subscription, item_count);
    }
    const StatusCode status = resend_data(all_, *context.session, subscription, context.now);
    if (status.is_good()) {
        item_count += all_.find(subscription)->item_count();
    }
    return CallResult{status};
}

} // namespace busbar::server::detail
