#include "print_capacities.hpp"

#include <cstdint>
#include <cstdio>
#include <vector>

#include "product/configuration/limits_section.hpp"
#include "product/configuration/memory_section.hpp"

namespace busbar::product {

namespace {

/// "65,535".
std::string with_commas(std::uint64_t number)
{
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) {
        at -= 3;
        text.insert(at, ",");
    }
    return text;
}

struct Capacity {
    std::string what;
    std::string value;
    /// As worst_case_memory() names it; its key of [limits] is told with it.
    std::string limit;
};

std::vector<Capacity> capacities_of(const ControllerConfig& config)
{
    const server::ServerLimits& limits = config.server.limits;
    const server::OperationLimits& operations = limits.operations;
    const server::SubscriptionLimits& subscriptions = limits.subscriptions;
    return {
        {"Sessions", with_commas(limits.max_sessions), "max_sessions"},
        {"Sessions of one user", with_commas(limits.max_sessions_per_user),
         "max_sessions_per_user"},
        {"SecureChannels", with_commas(limits.max_connections), "max_connections"},
        {"SecureChannels of one address", with_commas(limits.max_connections_per_address),
         "max_connections_per_address"},
        {"Subscriptions", with_commas(subscriptions.max_subscriptions),
         "subscriptions.max_subscriptions"},
        {"Subscriptions of one user", with_commas(subscriptions.max_subscriptions_per_user),
         "subscriptions.max_subscriptions_per_user"},
        {"Subscriptions of one Session", with_commas(subscriptions.max_subscriptions_per_session),
         "subscriptions.max_subscriptions_per_session"},
        {"MonitoredItems", with_commas(subscriptions.max_items), "subscriptions.max_items"},
        {"MonitoredItems of one user", with_commas(subscriptions.max_items_per_user),
         "subscriptions.max_items_per_user"},
        {"MonitoredItems of one Subscription",
         with_commas(subscriptions.max_items_per_subscription),
         "subscriptions.max_items_per_subscription"},
        {"values in the queue of a MonitoredItem", with_commas(subscriptions.max_queue_size),
         "subscriptions.max_queue_size"},
        {"Publish requests of one Session", with_commas(subscriptions.max_publish_requests),
         "subscriptions.max_publish_requests"},
        {"messages kept for Republish", with_commas(subscriptions.max_retransmission_messages),
         "subscriptions.max_retransmission_messages"},
        {"nodes in a Read", with_commas(operations.max_nodes_per_read),
         "operations.max_nodes_per_read"},
        {"nodes in a Write", with_commas(operations.max_nodes_per_write),
         "operations.max_nodes_per_write"},
        {"nodes in a Browse", with_commas(operations.max_nodes_per_browse),
         "operations.max_nodes_per_browse"},
        {"Methods in a Call", with_commas(operations.max_nodes_per_method_call),
         "operations.max_nodes_per_method_call"},
        {"MonitoredItems in a request", with_commas(operations.max_monitored_items_per_call),
         "operations.max_monitored_items_per_call"},
        {"references of one node in a Browse", with_commas(limits.max_references_per_node),
         "max_references_per_node"},
        {"continuation points of one Session", with_commas(limits.max_browse_continuation_points),
         "max_browse_continuation_points"},
        {"message", size_text(limits.transport.max_message_size), "transport.max_message_size"},
        {"elements of an array", with_commas(limits.decode.max_array_length),
         "decode.max_array_length"},
        {"String", size_text(limits.decode.max_string_length), "decode.max_string_length"},
        {"ByteString", size_text(limits.decode.max_byte_string_length),
         "decode.max_byte_string_length"},
    };
}

} // namespace

std::string describe_capacities(const ControllerConfig& config)
{
    std::string text = "| at most | | key in `[limits]` |\n|---|---|---|\n";
    for (const Capacity& capacity : capacities_of(config)) {
        const std::string key = key_of(capacity.limit);
        text += "| " + capacity.what + " | " + capacity.value + " | " +
                (key.empty() ? "" : "`" + key + "` ") + "|\n";
    }
    return text;
}

int print_capacities(const std::string& file)
{
    std::fputs(describe_capacities(read_config_or_default(file)).c_str(), stdout);
    return 0;
}

} // namespace busbar::product
