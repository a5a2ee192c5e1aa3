#include "limit_keys.hpp"

#include <array>
#include <chrono>
#include <type_traits>

#include "limits_section.hpp"

namespace busbar::product {

namespace {

constexpr std::int64_t most_connections = 100'000;
constexpr std::int64_t most_count = 10'000'000;
constexpr std::int64_t most_bytes = 67'108'864;
constexpr std::int64_t most_memory = std::int64_t{64} << 30; // a large machine's
constexpr std::int64_t least_message = 8'192;                // Part 6, 7.1.2.3: the least buffer
constexpr std::int64_t least_elements = 2;
constexpr std::int64_t longest = 86'400'000; // a day

// Where in a configuration a group of limits lies.

struct Limits {
    static auto& of(auto& config) { return config.server.limits; }
};
struct Transport {
    static auto& of(auto& config) { return config.server.limits.transport; }
};
struct Decode {
    static auto& of(auto& config) { return config.server.limits.decode; }
};
struct Operations {
    static auto& of(auto& config) { return config.server.limits.operations; }
};
struct Events {
    static auto& of(auto& config) { return config.server.limits.events; }
};
struct Filter {
    static auto& of(auto& config) { return config.server.limits.events.filter; }
};
struct Subscriptions {
    static auto& of(auto& config) { return config.server.limits.subscriptions; }
};
struct Sampling {
    static auto& of(auto& config) { return config.server.limits.subscriptions.sampling; }
};
struct Store {
    static auto& of(auto& config) { return config.certificates.limits; }
};
struct Passwords {
    static auto& of(auto& config) { return config.users.password_rules; }
};

template <typename T>
std::int64_t number_of(T figure)
{
    if constexpr (std::is_integral_v<T>) {
        return static_cast<std::int64_t>(figure);
    } else {
        return std::chrono::duration_cast<std::chrono::milliseconds>(figure).count();
    }
}

template <typename T>
T figure_of(std::int64_t number)
{
    if constexpr (std::is_integral_v<T>) {
        return static_cast<T>(number);
    } else {
        return std::chrono::milliseconds{number};
    }
}

template <typename Group, auto Member>
std::int64_t get(const ControllerConfig& config)
{
    return number_of(Group::of(config).*Member);
}

template <typename Group, auto Member>
void set(ControllerConfig& config, std::int64_t value)
{
    auto& figure = Group::of(config).*Member;
    figure = figure_of<std::remove_reference_t<decltype(figure)>>(value);
}

/// What it is called, what it may be set to.
struct Spelling {
    std::string_view table;
    std::string_view name;
    std::string_view limit;
    std::string_view unit;
    std::int64_t least;
    std::int64_t most;
};

template <typename Group, auto Member>
constexpr LimitKey key(const Spelling& as)
{
    return {as.table,           as.name, as.limit, as.unit, as.least, as.most, &get<Group, Member>,
            &set<Group, Member>};
}

constexpr std::array keys{
    key<Limits, &server::ServerLimits::max_connections>(
        {"limits", "connections", "max_connections", "", 1, most_connections}),
    key<Limits, &server::ServerLimits::max_connections_per_address>(
        {"limits", "connections_per_address", "max_connections_per_address", "", 1,
         most_connections}),
    key<Limits, &server::ServerLimits::max_sessions>(
        {"limits", "sessions", "max_sessions", "", 1, most_connections}),
    key<Limits, &server::ServerLimits::max_sessions_per_user>(
        {"limits", "sessions_per_user", "max_sessions_per_user", "", 1, most_connections}),
    key<Limits, &server::ServerLimits::max_sessions_per_channel>(
        {"limits", "sessions_per_channel", "max_sessions_per_channel", "", 1, most_connections}),
    key<Limits, &server::ServerLimits::max_references_per_node>(
        {"limits", "references_per_node", "max_references_per_node", "", 1, most_count}),
    key<Limits, &server::ServerLimits::max_browse_continuation_points>(
        {"limits", "browse_continuation_points", "max_browse_continuation_points", "", 1, 65'535}),
    key<Limits, &server::ServerLimits::max_browse_path_elements>(
        {"limits", "browse_path_elements", "max_browse_path_elements", "", 1, most_elements}),
    key<Limits, &server::ServerLimits::max_browse_path_targets>(
        {"limits", "browse_path_targets", "max_browse_path_targets", "", 1, most_elements}),
    key<Limits, &server::ServerLimits::max_pending_requests>(
        {"limits", "pending_requests", "max_pending_requests", "", 1, most_elements}),
    key<Limits, &server::ServerLimits::sessionless_timeout>(
        {"limits", "sessionless_timeout_ms", "sessionless_timeout", "ms", 100, longest}),
    key<Limits, &server::ServerLimits::max_sessionless_message>({"limits", "sessionless_message",
                                                                 "max_sessionless_message", "B",
                                                                 least_message, most_bytes}),
    key<Limits, &server::ServerLimits::max_send_queue>(
        {"limits", "send_queue", "max_send_queue", "B", least_message, most_memory}),
    key<Limits, &server::ServerLimits::send_timeout>(
        {"limits", "send_timeout_ms", "send_timeout", "ms", 100, longest}),
    key<Limits, &server::ServerLimits::max_assembly>(
        {"limits", "assembly", "max_assembly", "B", least_message, most_memory}),
    key<Limits, &server::ServerLimits::min_token_lifetime>(
        {"limits", "min_channel_lifetime_ms", "min_token_lifetime", "ms", 100, longest}),
    key<Limits, &server::ServerLimits::max_token_lifetime>(
        {"limits", "max_channel_lifetime_ms", "max_token_lifetime", "ms", 100, longest}),
    key<Limits, &server::ServerLimits::min_session_timeout>(
        {"limits", "min_session_timeout_ms", "min_session_timeout", "ms", 1, longest}),
    key<Limits, &server::ServerLimits::max_session_timeout>(
        {"limits", "max_session_timeout_ms", "max_session_timeout", "ms", 1, longest}),
    key<Limits, &server::ServerLimits::activation_timeout>(
        {"limits", "activation_timeout_ms", "activation_timeout", "ms", 100, longest}),
    key<Limits, &server::ServerLimits::max_session_memory>(
        {"limits", "session_memory", "max_session_memory", "B", least_message, most_memory}),
    key<Limits, &server::ServerLimits::max_locale_ids>(
        {"limits", "locale_ids", "max_locale_ids", "", 1, 1'000}),
    key<Limits, &server::ServerLimits::max_client_nodes>(
        {"limits", "client_nodes", "max_client_nodes", "", 0, most_count}),
    key<Limits, &server::ServerLimits::max_client_references>(
        {"limits", "client_references", "max_client_references", "", 0, most_count}),
    key<Limits, &server::ServerLimits::max_client_node_memory>(
        {"limits", "client_node_memory", "max_client_node_memory", "B", 0, most_memory}),
    key<Limits, &server::ServerLimits::max_login_failures>(
        {"limits", "login_failures", "max_login_failures", "", 1, 1'000}),
    key<Limits, &server::ServerLimits::max_login_failures_per_source>(
        {"limits", "login_failures_per_address", "max_login_failures_per_source", "", 1, 1'000}),
    key<Limits, &server::ServerLimits::login_lock>(
        {"limits", "login_lock_ms", "login_lock", "ms", 0, longest}),
    key<Limits, &server::ServerLimits::first_login_delay>(
        {"limits", "first_login_delay_ms", "first_login_delay", "ms", 0, 60'000}),
    key<Limits, &server::ServerLimits::max_login_delay>(
        {"limits", "max_login_delay_ms", "max_login_delay", "ms", 0, 60'000}),
    key<Limits, &server::ServerLimits::max_login_entries>(
        {"limits", "login_entries", "max_login_entries", "", 1, most_elements}),
    key<Limits, &server::ServerLimits::max_channel_burst>(
        {"limits", "channel_burst", "max_channel_burst", "", 1, 1'000}),
    key<Limits, &server::ServerLimits::channel_interval>(
        {"limits", "channel_interval_ms", "channel_interval", "ms", 0, 60'000}),
    key<Limits, &server::ServerLimits::max_channel_failures>(
        {"limits", "channel_failures", "max_channel_failures", "", 1, 1'000}),
    key<Limits, &server::ServerLimits::failed_channel_interval>(
        {"limits", "failed_channel_interval_ms", "failed_channel_interval", "ms", 0, 60'000}),
    key<Limits, &server::ServerLimits::max_channel_delay>(
        {"limits", "max_channel_delay_ms", "max_channel_delay", "ms", 0, 60'000}),
    key<Limits, &server::ServerLimits::max_channel_entries>(
        {"limits", "channel_entries", "max_channel_entries", "", 1, most_elements}),
    key<Limits, &server::ServerLimits::max_log_lines_per_minute>(
        {"limits", "log_lines_per_minute", "max_log_lines_per_minute", "", 1, most_elements}),
    key<Decode, &binary::DecodeLimits::max_array_length>(
        {"limits", "array_length", "decode.max_array_length", "", least_elements, most_elements}),
    key<Decode, &binary::DecodeLimits::max_string_length>(
        {"limits", "string_length", "decode.max_string_length", "B", 256, most_bytes}),
    key<Decode, &binary::DecodeLimits::max_byte_string_length>(
        {"limits", "byte_string_length", "decode.max_byte_string_length", "B", 256, most_bytes}),
    key<Decode, &binary::DecodeLimits::max_depth>(
        {"limits", "depth", "decode.max_depth", "", 8, 100}),
    key<Decode, &binary::DecodeLimits::max_diagnostic_depth>(
        {"limits", "diagnostic_depth", "decode.max_diagnostic_depth", "", 1, 100}),
    key<Decode, &binary::DecodeLimits::max_expansion>(
        {"limits", "expansion", "decode.max_expansion", "", 1, 1'000}),
    key<Decode, &binary::DecodeLimits::free_memory>(
        {"limits", "free_memory", "decode.free_memory", "B", 4096, most_bytes}),
    key<Transport, &channel::TransportLimits::max_message_size>(
        {"limits", "message_size", "transport.max_message_size", "B", least_message, most_bytes}),
    key<Transport, &channel::TransportLimits::max_chunk_count>(
        {"limits", "chunk_count", "transport.max_chunk_count", "", 1, most_elements}),
    key<Transport, &channel::TransportLimits::receive_buffer_size>({"limits", "receive_buffer_size",
                                                                    "transport.receive_buffer_size",
                                                                    "B", least_message, 65'535}),
    key<Transport, &channel::TransportLimits::send_buffer_size>(
        {"limits", "send_buffer_size", "transport.send_buffer_size", "B", least_message, 65'535}),
    key<Transport, &channel::TransportLimits::handshake_timeout>(
        {"limits", "handshake_timeout_ms", "transport.handshake_timeout", "ms", 100, longest}),
    key<Operations, &server::OperationLimits::max_nodes_per_read>(
        {"limits", "nodes_per_read", "operations.max_nodes_per_read", "", 1, most_elements}),
    key<Operations, &server::OperationLimits::max_nodes_per_write>(
        {"limits", "nodes_per_write", "operations.max_nodes_per_write", "", 1, most_elements}),
    key<Operations, &server::OperationLimits::max_nodes_per_browse>(
        {"limits", "nodes_per_browse", "operations.max_nodes_per_browse", "", 1, most_elements}),
    key<Operations, &server::OperationLimits::max_nodes_per_register_nodes>(
        {"limits", "nodes_per_register", "operations.max_nodes_per_register_nodes", "", 1,
         most_elements}),
    key<Operations, &server::OperationLimits::max_nodes_per_translate_browse_paths>(
        {"limits", "browse_paths_per_translate", "operations.max_nodes_per_translate_browse_paths",
         "", 1, most_elements}),
    key<Operations, &server::OperationLimits::max_nodes_per_method_call>(
        {"limits", "methods_per_call", "operations.max_nodes_per_method_call", "", 1,
         most_elements}),
    key<Operations, &server::OperationLimits::max_nodes_per_node_management>(
        {"limits", "nodes_per_node_management", "operations.max_nodes_per_node_management", "", 1,
         most_elements}),
    key<Operations, &server::OperationLimits::max_monitored_items_per_call>(
        {"limits", "items_per_call", "operations.max_monitored_items_per_call", "", 1,
         most_elements}),
    key<Filter, &server::EventFilterLimits::max_select_clauses>({"limits.events", "select_clauses",
                                                                 "events.filter.max_select_clauses",
                                                                 "", 1, most_elements}),
    key<Filter, &server::EventFilterLimits::max_elements>(
        {"limits.events", "where_elements", "events.filter.max_elements", "", 1, most_elements}),
    key<Filter, &server::EventFilterLimits::max_operands>(
        {"limits.events", "where_operands", "events.filter.max_operands", "", 1, most_elements}),
    key<Filter, &server::EventFilterLimits::max_path_elements>({"limits.events", "path_elements",
                                                                "events.filter.max_path_elements",
                                                                "", 1, most_elements}),
    key<Filter, &server::EventFilterLimits::max_literal_size>(
        {"limits.events", "literal_size", "events.filter.max_literal_size", "B", 1, most_elements}),
    key<Events, &server::EventLimits::max_raised_events>(
        {"limits.events", "raised_events", "events.max_raised_events", "", 1, most_elements}),
    key<Events, &server::EventLimits::max_notifiers>(
        {"limits.events", "notifiers", "events.max_notifiers", "", 1, most_elements}),
    key<Subscriptions, &server::SubscriptionLimits::max_subscriptions_per_session>(
        {"limits.subscriptions", "per_session", "subscriptions.max_subscriptions_per_session", "",
         1, most_connections}),
    key<Subscriptions, &server::SubscriptionLimits::max_subscriptions_per_user>(
        {"limits.subscriptions", "per_user", "subscriptions.max_subscriptions_per_user", "", 1,
         most_connections}),
    key<Subscriptions, &server::SubscriptionLimits::max_subscriptions>(
        {"limits.subscriptions", "in_all", "subscriptions.max_subscriptions", "", 1,
         most_connections}),
    key<Subscriptions, &server::SubscriptionLimits::max_items_per_subscription>(
        {"limits.subscriptions", "items_per_subscription",
         "subscriptions.max_items_per_subscription", "", 1, most_count}),
    key<Subscriptions, &server::SubscriptionLimits::max_items_per_user>(
        {"limits.subscriptions", "items_per_user", "subscriptions.max_items_per_user", "", 1,
         most_count}),
    key<Subscriptions, &server::SubscriptionLimits::max_items>(
        {"limits.subscriptions", "items", "subscriptions.max_items", "", 1, most_count}),
    key<Subscriptions, &server::SubscriptionLimits::max_triggering_links>(
        {"limits.subscriptions", "triggering_links", "subscriptions.max_triggering_links", "", 0,
         most_elements}),
    key<Subscriptions, &server::SubscriptionLimits::min_publishing_interval>(
        {"limits.subscriptions", "min_publishing_interval_ms",
         "subscriptions.min_publishing_interval", "ms", 1, longest}),
    key<Subscriptions, &server::SubscriptionLimits::max_publishing_interval>(
        {"limits.subscriptions", "max_publishing_interval_ms",
         "subscriptions.max_publishing_interval", "ms", 1, longest}),
    key<Subscriptions, &server::SubscriptionLimits::min_keep_alive>(
        {"limits.subscriptions", "min_keep_alive_ms", "subscriptions.min_keep_alive", "ms", 0,
         longest}),
    key<Subscriptions, &server::SubscriptionLimits::max_keep_alive>(
        {"limits.subscriptions", "max_keep_alive_ms", "subscriptions.max_keep_alive", "ms", 1,
         longest}),
    key<Subscriptions, &server::SubscriptionLimits::min_lifetime>(
        {"limits.subscriptions", "min_lifetime_ms", "subscriptions.min_lifetime", "ms", 0,
         longest}),
    key<Subscriptions, &server::SubscriptionLimits::max_lifetime>(
        {"limits.subscriptions", "max_lifetime_ms", "subscriptions.max_lifetime", "ms", 1,
         longest}),
    key<Subscriptions, &server::SubscriptionLimits::max_notifications_per_publish>(
        {"limits.subscriptions", "notifications_per_publish",
         "subscriptions.max_notifications_per_publish", "", 1, most_count}),
    key<Subscriptions, &server::SubscriptionLimits::max_queue_size>(
        {"limits.subscriptions", "queue_size", "subscriptions.max_queue_size", "", 1, most_count}),
    key<Subscriptions, &server::SubscriptionLimits::max_event_queue_size>(
        {"limits.subscriptions", "event_queue_size", "subscriptions.max_event_queue_size", "", 1,
         most_count}),
    key<Subscriptions, &server::SubscriptionLimits::max_publish_requests>(
        {"limits.subscriptions", "publish_requests", "subscriptions.max_publish_requests", "", 1,
         1'000}),
    key<Subscriptions, &server::SubscriptionLimits::max_acknowledgements>(
        {"limits.subscriptions", "acknowledgements", "subscriptions.max_acknowledgements", "", 1,
         most_elements}),
    key<Subscriptions, &server::SubscriptionLimits::max_retransmission_messages>(
        {"limits.subscriptions", "retransmission_messages",
         "subscriptions.max_retransmission_messages", "", 2, most_elements}),
    key<Subscriptions, &server::SubscriptionLimits::max_message_size>(
        {"limits.subscriptions", "message_size", "subscriptions.max_message_size", "B",
         least_message, most_bytes}),
    key<Subscriptions, &server::SubscriptionLimits::max_status_changes>(
        {"limits.subscriptions", "status_changes", "subscriptions.max_status_changes", "", 1,
         most_elements}),
    key<Subscriptions, &server::SubscriptionLimits::max_subscription_memory>(
        {"limits.subscriptions", "memory_per_subscription", "subscriptions.max_subscription_memory",
         "B", least_message, most_memory}),
    key<Subscriptions, &server::SubscriptionLimits::max_memory>({"limits.subscriptions", "memory",
                                                                 "subscriptions.max_memory", "B",
                                                                 least_message, most_memory}),
    key<Sampling, &server::SamplingPolicy::min_interval>(
        {"limits.subscriptions", "min_sampling_interval_ms", "subscriptions.sampling.min_interval",
         "ms", 0, longest}),
    key<Sampling, &server::SamplingPolicy::max_interval>(
        {"limits.subscriptions", "max_sampling_interval_ms", "subscriptions.sampling.max_interval",
         "ms", 1, longest}),
    key<Store, &crypto::StoreLimits::max_certificates>(
        {"limits.certificates", "certificates", "", "", 1, most_elements}),
    key<Store, &crypto::StoreLimits::max_revocation_lists>(
        {"limits.certificates", "revocation_lists", "", "", 1, most_elements}),
    key<Store, &crypto::StoreLimits::max_rejected>(
        {"limits.certificates", "rejected", "", "", 0, most_elements}),
    key<Store, &crypto::StoreLimits::max_rejected_per_minute>(
        {"limits.certificates", "rejected_per_minute", "", "", 0, most_elements}),
    key<Store, &crypto::StoreLimits::max_files>(
        {"limits.certificates", "files", "", "", 1, most_elements}),
    key<Store, &crypto::StoreLimits::max_certificate_file_size>(
        {"limits.certificates", "certificate_size", "", "B", 1024, most_bytes}),
    key<Store, &crypto::StoreLimits::max_revocation_list_file_size>(
        {"limits.certificates", "revocation_list_size", "", "B", 1024, most_bytes}),
    key<Store, &crypto::StoreLimits::max_folder_size>(
        {"limits.certificates", "folder_size", "", "B", 1024, most_memory}),
    key<Passwords, &server::PasswordRules::min_name_length>(
        {"users.passwords", "min_name_length", "", "", 1, 64}),
    key<Passwords, &server::PasswordRules::max_name_length>(
        {"users.passwords", "max_name_length", "", "B", 1, 1'000}),
    key<Passwords, &server::PasswordRules::min_password_length>(
        {"users.passwords", "min_password_length", "", "", 1, 64}),
    key<Passwords, &server::PasswordRules::max_password_length>(
        {"users.passwords", "max_password_length", "", "B", 1, 1'000}),
    key<Passwords, &server::PasswordRules::max_users>(
        {"users.passwords", "users", "", "", 1, most_elements}),
};

} // namespace

std::span<const LimitKey> limit_keys()
{
    return keys;
}

} // namespace busbar::product
