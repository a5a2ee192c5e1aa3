#include <busbar/server/limits.hpp>

namespace busbar::server {

namespace {

OperationLimits small_operations()
{
    OperationLimits limits;
    limits.max_nodes_per_read = 500;
    limits.max_nodes_per_write = 500;
    limits.max_nodes_per_browse = 100;
    limits.max_nodes_per_register_nodes = 100;
    limits.max_nodes_per_translate_browse_paths = 100;
    limits.max_nodes_per_method_call = 20;
    limits.max_nodes_per_node_management = 10;
    limits.max_monitored_items_per_call = 250;
    return limits;
}

SubscriptionLimits small_subscriptions()
{
    SubscriptionLimits limits;
    limits.max_subscriptions_per_session = 4;
    limits.max_subscriptions_per_user = 6;
    limits.max_subscriptions = 10;
    limits.max_items_per_subscription = 500;
    limits.max_items_per_user = 750;
    limits.max_items = 1'000;
    limits.max_triggering_links = 32;
    limits.min_publishing_interval = std::chrono::milliseconds{50};
    limits.max_notifications_per_publish = 500;
    limits.max_queue_size = 10;
    limits.max_event_queue_size = 50;
    limits.sampling.min_interval = std::chrono::milliseconds{50};
    limits.max_publish_requests = 5;
    limits.max_acknowledgements = 100;
    limits.max_retransmission_messages = 10;
    limits.max_message_size = 32U << 10U;
    limits.max_status_changes = 10;
    limits.max_subscription_memory = 1U << 20U;
    limits.max_memory = 3U << 20U;
    return limits;
}

} // namespace

ServerLimits small_controller_limits()
{
    ServerLimits limits;
    limits.transport.receive_buffer_size = channel::min_buffer_size;
    limits.transport.send_buffer_size = channel::min_buffer_size;
    limits.transport.max_message_size = 48U << 10U;
    limits.transport.max_chunk_count = 16;
    limits.decode.max_string_length = 4'096;
    limits.decode.max_byte_string_length = 32U << 10U;
    limits.decode.max_array_length = 8'192;
    limits.decode.free_memory = 16U << 10U;
    limits.operations = small_operations();
    limits.max_connections = 5;
    limits.max_connections_per_address = 5;
    limits.max_sessionless_message = 16U << 10U;
    limits.max_send_queue = 128U << 10U;
    limits.max_pending_requests = 20;
    limits.max_assembly = 192U << 10U;
    limits.max_sessions = 5;
    limits.max_sessions_per_user = 4;
    limits.max_sessions_per_channel = 2;
    limits.max_session_memory = 256U << 10U;
    limits.max_locale_ids = 4;
    limits.max_browse_continuation_points = 5;
    limits.max_references_per_node = 250;
    limits.max_browse_path_elements = 32;
    limits.max_browse_path_targets = 100;
    limits.max_client_nodes = 0;
    limits.max_client_references = 0;
    limits.max_client_node_memory = 0;
    limits.events.filter.max_select_clauses = 30;
    limits.events.filter.max_elements = 16;
    limits.events.filter.max_operands = 16;
    limits.events.filter.max_literal_size = 512;
    limits.events.max_raised_events = 64;
    limits.events.max_notifiers = 100;
    limits.subscriptions = small_subscriptions();
    limits.max_channel_burst = 5;
    limits.channel_interval = std::chrono::milliseconds{250};
    limits.max_channel_entries = 32;
    limits.max_login_entries = 32;
    return limits;
}

} // namespace busbar::server
