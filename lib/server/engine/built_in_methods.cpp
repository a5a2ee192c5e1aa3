#include "built_in_methods.hpp"

#include <array>

#include <busbar/types/ids.hpp>

#include "server/engine/core.hpp"
#include "server/subscription/subscription.hpp"
#include "server/subscription/subscription_services.hpp"

namespace busbar::server::detail {

namespace {

/// What both Methods take: the id of a Subscription.
std::uint32_t subscription_id(std::span<const Variant> inputs)
{
    return inputs.empty() ? 0 : inputs[0].value_or<std::uint32_t>(0);
}

/// Part 5, 9.1
CallResult call_get_monitored_items(ServiceContext& context, std::span<const Variant> inputs,
                                    std::size_t& item_count)
{
    auto handles = get_monitored_items(context.core, *context.session, subscription_id(inputs));
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

/// Part 5, 9.2
CallResult call_resend_data(ServiceContext& context, std::span<const Variant> inputs,
                            std::size_t& item_count)
{
    const std::uint32_t id = subscription_id(inputs);
    const StatusCode status = resend_data(context.core, *context.session, id, context.now);
    if (status.is_good()) {
        item_count += context.core.subscriptions.find(id)->item_count();
    }
    return CallResult{status};
}

constexpr std::array methods{
    BuiltInMethod{id::Server_GetMonitoredItems, call_get_monitored_items},
    BuiltInMethod{id::Server_ResendData, call_resend_data},
};

} // namespace

const BuiltInMethod* find_built_in_method(const NodeId& method_id)
{
    for (const BuiltInMethod& method : methods) {
        if (method_id.is(method.method_id)) {
            return &method;
        }
    }
    return nullptr;
}

} // namespace busbar::server::detail
