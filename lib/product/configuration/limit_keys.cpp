#include "limit_keys.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <type_traits>
#include <utility>

#include "sections.hpp"

namespace busbar::product {

namespace {

constexpr std::int64_t most_connections = 100'000;
constexpr std::int64_t most_count = 10'000'000;
constexpr std::int64_t most_bytes = 67'108'864;
constexpr std::int64_t most_memory = std::int64_t{64} << 30; // a large machine's
constexpr std::int64_t least_message = 8'192;                // Part 6, 7.1.2.3: the least buffer
constexpr std::int64_t least_elements = 2;
constexpr std::int64_t longest = 86'400'000; // a day
constexpr std::int64_t most_points = 16'000'000;

using Limits = server::ServerLimits;
using Transport = channel::TransportLimits;
using Decode = binary::DecodeLimits;
using Operations = server::OperationLimits;
using Events = server::EventLimits;
using Filter = server::EventFilterLimits;
using Subscriptions = server::SubscriptionLimits;
using Sampling = server::SamplingPolicy;
using Store = crypto::StoreLimits;
using Passwords = server::PasswordRules;
using Log = controller::ExecutionLogSettings;
using Labels = controller::SimulatedLabelsOptions;

/// Properties that all limits of a struct share.
struct Common {
    std::string_view table;
    bool is_live{false};
    bool is_security{false};
    bool is_setting{true};
};

/// The properties for each struct.
struct Commons {
    static constexpr std::string_view subscriptions = "limits.subscriptions";

    static constexpr Common of(Limits*) { return {"limits", true}; }
    // existing buffers keep their size
    static constexpr Common of(Transport*) { return {"limits"}; }
    static constexpr Common of(Decode*) { return {"limits", true}; }
    static constexpr Common of(Operations*) { return {"limits", true}; }
    static constexpr Common of(Events*) { return {"limits.events", true}; }
    static constexpr Common of(Filter*) { return {"limits.events", true}; }
    static constexpr Common of(Subscriptions*) { return {subscriptions, true}; }
    static constexpr Common of(Sampling*) { return {subscriptions, true}; }
    static constexpr Common of(Store*) { return {"limits.certificates", false, true}; }
    static constexpr Common of(Passwords*) { return {"users.passwords", false, true}; }
    static constexpr Common of(CertificateConfig*) { return {"certificates", false, true}; }
    static constexpr Common of(DiscoveryConfig*) { return {"discovery"}; }
    static constexpr Common of(Log*) { return {"machine"}; }
    static constexpr Common of(MachineConfig*) { return {"machine", false, false, false}; }
    static constexpr Common of(Labels*) { return {"labels", false, false, false}; }
    static constexpr Common of(LabelConfig*) { return {"labels", false, false, false}; }
    static constexpr Common of(server::ImageOptions*) { return {"plc"}; }
    static constexpr Common of(ControllerConfig*) { return {"plc"}; }
};

/// Finds each struct in a configuration.
struct Place {
    static auto& of(auto& config, Limits*) { return config.server.limits; }
    static auto& of(auto& config, Transport*) { return config.server.limits.transport; }
    static auto& of(auto& config, Decode*) { return config.server.limits.decode; }
    static auto& of(auto& config, Operations*) { return config.server.limits.operations; }
    static auto& of(auto& config, Events*) { return config.server.limits.events; }
    static auto& of(auto& config, Filter*) { return config.server.limits.events.filter; }
    static auto& of(auto& config, Subscriptions*) { return config.server.limits.subscriptions; }
    static auto& of(auto& config, Sampling*) { return config.server.limits.subscriptions.sampling; }
    static auto& of(auto& config, Store*) { return config.certificates.limits; }
    static auto& of(auto& config, Passwords*) { return config.users.password_rules; }
    static auto& of(auto& config, CertificateConfig*) { return config.certificates; }
    static auto& of(auto& config, DiscoveryConfig*) { return config.discovery; }
    static auto& of(auto& config, Log*) { return config.machine.execution_log; }
    static auto& of(auto& config, MachineConfig*) { return config.machine; }
    static auto& of(auto& config, Labels*) { return config.labels.options; }
    static auto& of(auto& config, LabelConfig*) { return config.labels; }
    static auto& of(auto& config, server::ImageOptions*) { return config.image; }
    static auto& of(auto& config, ControllerConfig*) { return config; }
};

template <typename Struct, typename Figure>
Struct struct_of(Figure Struct::*);
template <typename Struct, typename Figure>
Figure figure_of(Figure Struct::*);
template <auto Member>
using StructOf = decltype(struct_of(Member));
template <auto Member>
using FigureOf = decltype(figure_of(Member));

/// The unit of a number: seconds, or milliseconds for all other times.
template <typename Figure>
using TimeUnit = std::conditional_t<std::is_same_v<Figure, std::chrono::seconds>,
                                    std::chrono::seconds, std::chrono::milliseconds>;

template <auto Member>
std::int64_t get(const ControllerConfig& config)
{
    const auto& figure = Place::of(config, static_cast<StructOf<Member>*>(nullptr)).*Member;
    if constexpr (std::is_integral_v<FigureOf<Member>>) {
        return static_cast<std::int64_t>(figure);
    } else {
        return std::chrono::duration_cast<TimeUnit<FigureOf<Member>>>(figure).count();
    }
}

template <auto Member>
void set(ControllerConfig& config, std::int64_t value)
{
    auto& figure = Place::of(config, static_cast<StructOf<Member>*>(nullptr)).*Member;
    if constexpr (std::is_integral_v<FigureOf<Member>>) {
        figure = static_cast<FigureOf<Member>>(value);
    } else {
        figure = TimeUnit<FigureOf<Member>>{value};
    }
}

/// Properties that few limits have.
struct More {
    std::string_view table{};
    std::string_view unit{};
    LimitEntry capacity{};
    /// The same as the key by default.
    LimitEntry figure{};
    bool is_security{false};
    bool at_restart{false};
};

template <auto Member>
constexpr LimitKey row(std::string_view name, std::string_view cost, std::int64_t least,
                       std::int64_t most, More more = {})
{
    using Figure = FigureOf<Member>;
    const Common common = Commons::of(static_cast<StructOf<Member>*>(nullptr));
    if (!std::is_integral_v<Figure>) {
        more.unit = std::is_same_v<Figure, std::chrono::seconds> ? "s" : "ms";
    }
    if (more.figure.place != 0 && more.figure.name.empty()) {
        more.figure.name = name;
    }
    return {.table = more.table.empty() ? common.table : more.table,
            .name = name,
            .cost = cost,
            .unit = more.unit,
            .least = least,
            .most = most,
            .capacity = more.capacity,
            .figure = more.figure,
            .is_setting = common.is_setting,
            .is_live = common.is_live && !more.at_restart,
            .is_security = common.is_security || more.is_security,
            .get = &get<Member>,
            .set = &set<Member>};
}

constexpr LimitKey keys[] = {
    row<&Limits::max_connections>("connections", "max_connections", 1, most_connections,
                                  {.capacity = {3, "SecureChannels"}}),
    row<&Limits::max_connections_per_address>("connections_per_address",
                                              "max_connections_per_address", 1, most_connections,
                                              {.capacity = {4, "SecureChannels of one address"}}),
    row<&Limits::max_sessions>("sessions", "max_sessions", 1, most_connections,
                               {.capacity = {1, "Sessions"}, .figure = {1}}),
    row<&Limits::max_sessions_per_user>("sessions_per_user", "max_sessions_per_user", 1,
                                        most_connections,
                                        {.capacity = {2, "Sessions of one user"}}),
    row<&Limits::max_sessions_per_channel>("sessions_per_channel", "max_sessions_per_channel", 1,
                                           most_connections),
    row<&Limits::max_references_per_node>("references_per_node", "max_references_per_node", 1,
                                          most_count,
                                          {.capacity = {19, "references of one node in a Browse"}}),
    row<&Limits::max_browse_continuation_points>(
        "browse_continuation_points", "max_browse_continuation_points", 1, 65'535,
        {.capacity = {20, "continuation points of one Session"}}),
    row<&Limits::max_browse_path_elements>("browse_path_elements", "max_browse_path_elements", 1,
                                           most_elements),
    row<&Limits::max_browse_path_targets>("browse_path_targets", "max_browse_path_targets", 1,
                                          most_elements),
    row<&Limits::max_pending_requests>("pending_requests", "max_pending_requests", 1,
                                       most_elements),
    row<&Limits::sessionless_timeout>("sessionless_timeout_ms", "sessionless_timeout", 100,
                                      longest),
    row<&Limits::max_sessionless_message>("sessionless_message", "max_sessionless_message",
                                          least_message, most_bytes, {.unit = "B"}),
    row<&Limits::max_send_queue>("send_queue", "max_send_queue", least_message, most_memory,
                                 {.unit = "B"}),
    row<&Limits::send_timeout>("send_timeout_ms", "send_timeout", 100, longest),
    row<&Limits::max_assembly>("assembly", "max_assembly", least_message, most_memory,
                               {.unit = "B", .at_restart = true}),
    row<&Limits::min_token_lifetime>("min_channel_lifetime_ms", "min_token_lifetime", 100, longest),
    row<&Limits::max_token_lifetime>("max_channel_lifetime_ms", "max_token_lifetime", 100, longest),
    row<&Limits::min_session_timeout>("min_session_timeout_ms", "min_session_timeout", 1, longest,
                                      {.figure = {2}}),
    row<&Limits::max_session_timeout>("max_session_timeout_ms", "max_session_timeout", 1, longest,
                                      {.figure = {3}}),
    row<&Limits::activation_timeout>("activation_timeout_ms", "activation_timeout", 100, longest),
    row<&Limits::max_session_memory>("session_memory", "max_session_memory", least_message,
                                     most_memory, {.unit = "B"}),
    row<&Limits::max_locale_ids>("locale_ids", "max_locale_ids", 1, 1'000),
    row<&Limits::max_client_nodes>("client_nodes", "max_client_nodes", 0, most_count),
    row<&Limits::max_client_references>("client_references", "max_client_references", 0,
                                        most_count),
    row<&Limits::max_client_node_memory>("client_node_memory", "max_client_node_memory", 0,
                                         most_memory, {.unit = "B"}),
    row<&Limits::max_login_failures>("login_failures", "max_login_failures", 1, 1'000,
                                     {.is_security = true}),
    row<&Limits::max_login_failures_per_source>("login_failures_per_address",
                                                "max_login_failures_per_source", 1, 1'000,
                                                {.is_security = true}),
    row<&Limits::login_lock>("login_lock_ms", "login_lock", 0, longest, {.is_security = true}),
    row<&Limits::first_login_delay>("first_login_delay_ms", "first_login_delay", 0, 60'000,
                                    {.is_security = true}),
    row<&Limits::max_login_delay>("max_login_delay_ms", "max_login_delay", 0, 60'000,
                                  {.is_security = true}),
    row<&Limits::max_login_entries>("login_entries", "max_login_entries", 1, most_elements,
                                    {.is_security = true}),
    row<&Limits::max_channel_burst>("channel_burst", "max_channel_burst", 1, 1'000),
    row<&Limits::channel_interval>("channel_interval_ms", "channel_interval", 0, 60'000),
    row<&Limits::max_channel_failures>("channel_failures", "max_channel_failures", 1, 1'000),
    row<&Limits::failed_channel_interval>("failed_channel_interval_ms", "failed_channel_interval",
                                          0, 60'000),
    row<&Limits::max_channel_delay>("max_channel_delay_ms", "max_channel_delay", 0, 60'000),
    row<&Limits::max_channel_entries>("channel_entries", "max_channel_entries", 1, most_elements),
    row<&Limits::max_log_lines_per_minute>("log_lines_per_minute", "max_log_lines_per_minute", 1,
                                           most_elements),
    row<&Decode::max_array_length>("array_length", "decode.max_array_length", least_elements,
                                   most_elements,
                                   {.capacity = {22, "elements of an array"}, .figure = {12}}),
    row<&Decode::max_string_length>("string_length", "decode.max_string_length", 256, most_bytes,
                                    {.unit = "B", .capacity = {23, "String"}, .figure = {10}}),
    row<&Decode::max_byte_string_length>(
        "byte_string_length", "decode.max_byte_string_length", 256, most_bytes,
        {.unit = "B", .capacity = {24, "ByteString"}, .figure = {11}}),
    row<&Decode::max_depth>("depth", "decode.max_depth", 8, 100),
    row<&Decode::max_diagnostic_depth>("diagnostic_depth", "decode.max_diagnostic_depth", 1, 100),
    row<&Decode::max_expansion>("expansion", "decode.max_expansion", 1, 1'000),
    row<&Decode::free_memory>("free_memory", "decode.free_memory", 4096, most_bytes, {.unit = "B"}),
    row<&Transport::max_message_size>("message_size", "transport.max_message_size", least_message,
                                      most_bytes,
                                      {.unit = "B", .capacity = {21, "message"}, .figure = {9}}),
    row<&Transport::max_chunk_count>("chunk_count", "transport.max_chunk_count", 1, most_elements),
    row<&Transport::receive_buffer_size>("receive_buffer_size", "transport.receive_buffer_size",
                                         least_message, 65'535, {.unit = "B"}),
    row<&Transport::send_buffer_size>("send_buffer_size", "transport.send_buffer_size",
                                      least_message, 65'535, {.unit = "B"}),
    row<&Transport::handshake_timeout>("handshake_timeout_ms", "transport.handshake_timeout", 100,
                                       longest),
    row<&Operations::max_nodes_per_read>("nodes_per_read", "operations.max_nodes_per_read", 1,
                                         most_elements,
                                         {.capacity = {14, "nodes in a Read"}, .figure = {4}}),
    row<&Operations::max_nodes_per_write>("nodes_per_write", "operations.max_nodes_per_write", 1,
                                          most_elements,
                                          {.capacity = {15, "nodes in a Write"}, .figure = {5}}),
    row<&Operations::max_nodes_per_browse>("nodes_per_browse", "operations.max_nodes_per_browse", 1,
                                           most_elements,
                                           {.capacity = {16, "nodes in a Browse"}, .figure = {6}}),
    row<&Operations::max_nodes_per_register_nodes>(
        "nodes_per_register", "operations.max_nodes_per_register_nodes", 1, most_elements),
    row<&Operations::max_nodes_per_translate_browse_paths>(
        "browse_paths_per_translate", "operations.max_nodes_per_translate_browse_paths", 1,
        most_elements, {.figure = {7, "nodes_per_translate_browse_paths"}}),
    row<&Operations::max_nodes_per_method_call>(
        "methods_per_call", "operations.max_nodes_per_method_call", 1, most_elements,
        {.capacity = {17, "Methods in a Call"}, .figure = {8}}),
    row<&Operations::max_nodes_per_node_management>(
        "nodes_per_node_management", "operations.max_nodes_per_node_management", 1, most_elements),
    row<&Operations::max_monitored_items_per_call>(
        "items_per_call", "operations.max_monitored_items_per_call", 1, most_elements,
        {.capacity = {18, "MonitoredItems in a request"}}),
    row<&Filter::max_select_clauses>("select_clauses", "events.filter.max_select_clauses", 1,
                                     most_elements),
    row<&Filter::max_elements>("where_elements", "events.filter.max_elements", 1, most_elements),
    row<&Filter::max_operands>("where_operands", "events.filter.max_operands", 1, most_elements),
    row<&Filter::max_path_elements>("path_elements", "events.filter.max_path_elements", 1,
                                    most_elements),
    row<&Filter::max_literal_size>("literal_size", "events.filter.max_literal_size", 1,
                                   most_elements, {.unit = "B"}),
    row<&Events::max_raised_events>("raised_events", "events.max_raised_events", 1, most_elements),
    row<&Events::max_notifiers>("notifiers", "events.max_notifiers", 1, most_elements),
    row<&Subscriptions::max_subscriptions_per_session>(
        "per_session", "subscriptions.max_subscriptions_per_session", 1, most_connections,
        {.capacity = {7, "Subscriptions of one Session"},
         .figure = {14, "subscriptions_per_session"}}),
    row<&Subscriptions::max_subscriptions_per_user>(
        "per_user", "subscriptions.max_subscriptions_per_user", 1, most_connections,
        {.capacity = {6, "Subscriptions of one user"}}),
    row<&Subscriptions::max_subscriptions>(
        "in_all", "subscriptions.max_subscriptions", 1, most_connections,
        {.capacity = {5, "Subscriptions"}, .figure = {13, "subscriptions"}}),
    row<&Subscriptions::max_items_per_subscription>(
        "items_per_subscription", "subscriptions.max_items_per_subscription", 1, most_count,
        {.capacity = {10, "MonitoredItems of one Subscription"}}),
    row<&Subscriptions::max_items_per_user>("items_per_user", "subscriptions.max_items_per_user", 1,
                                            most_count,
                                            {.capacity = {9, "MonitoredItems of one user"}}),
    row<&Subscriptions::max_items>("items", "subscriptions.max_items", 1, most_count,
                                   {.capacity = {8, "MonitoredItems"}, .figure = {15}}),
    row<&Subscriptions::max_triggering_links>(
        "triggering_links", "subscriptions.max_triggering_links", 0, most_elements),
    row<&Subscriptions::min_publishing_interval>("min_publishing_interval_ms",
                                                 "subscriptions.min_publishing_interval", 1,
                                                 longest, {.figure = {17}}),
    row<&Subscriptions::max_publishing_interval>(
        "max_publishing_interval_ms", "subscriptions.max_publishing_interval", 1, longest),
    row<&Subscriptions::min_keep_alive>("min_keep_alive_ms", "subscriptions.min_keep_alive", 0,
                                        longest, {.figure = {18}}),
    row<&Subscriptions::max_keep_alive>("max_keep_alive_ms", "subscriptions.max_keep_alive", 1,
                                        longest),
    row<&Subscriptions::min_lifetime>("min_lifetime_ms", "subscriptions.min_lifetime", 0, longest,
                                      {.figure = {19}}),
    row<&Subscriptions::max_lifetime>("max_lifetime_ms", "subscriptions.max_lifetime", 1, longest),
    row<&Subscriptions::max_notifications_per_publish>(
        "notifications_per_publish", "subscriptions.max_notifications_per_publish", 1, most_count),
    row<&Subscriptions::max_queue_size>(
        "queue_size", "subscriptions.max_queue_size", 1, most_count,
        {.capacity = {11, "values in the queue of a MonitoredItem"}, .figure = {16}}),
    row<&Subscriptions::max_event_queue_size>("event_queue_size",
                                              "subscriptions.max_event_queue_size", 1, most_count),
    row<&Subscriptions::max_publish_requests>(
        "publish_requests", "subscriptions.max_publish_requests", 1, 1'000,
        {.capacity = {12, "Publish requests of one Session"}}),
    row<&Subscriptions::max_acknowledgements>(
        "acknowledgements", "subscriptions.max_acknowledgements", 1, most_elements),
    row<&Subscriptions::max_retransmission_messages>(
        "retransmission_messages", "subscriptions.max_retransmission_messages", 2, most_elements,
        {.capacity = {13, "messages kept for Republish"}}),
    row<&Subscriptions::max_message_size>("message_size", "subscriptions.max_message_size",
                                          least_message, most_bytes, {.unit = "B"}),
    row<&Subscriptions::max_status_changes>("status_changes", "subscriptions.max_status_changes", 1,
                                            most_elements),
    row<&Subscriptions::max_subscription_memory>("memory_per_subscription",
                                                 "subscriptions.max_subscription_memory",
                                                 least_message, most_memory, {.unit = "B"}),
    row<&Subscriptions::max_memory>("memory", "subscriptions.max_memory", least_message,
                                    most_memory, {.unit = "B"}),
    row<&Sampling::min_interval>("min_sampling_interval_ms", "subscriptions.sampling.min_interval",
                                 0, longest, {.figure = {20}}),
    row<&Sampling::max_interval>("max_sampling_interval_ms", "subscriptions.sampling.max_interval",
                                 1, longest, {.figure = {21}}),
    row<&Store::max_certificates>("certificates", {}, 1, most_elements,
                                  {.figure = {35, "trusted_certificates"}}),
    row<&Store::max_revocation_lists>("revocation_lists", {}, 1, most_elements),
    row<&Store::max_rejected>("rejected", {}, 0, most_elements,
                              {.figure = {37, "rejected_certificates"}}),
    row<&Store::max_rejected_per_minute>("rejected_per_minute", {}, 0, most_elements),
    row<&Store::max_files>("files", {}, 1, most_elements),
    row<&Store::max_certificate_file_size>("certificate_size", {}, 1024, most_bytes, {.unit = "B"}),
    row<&Store::max_revocation_list_file_size>("revocation_list_size", {}, 1024, most_bytes,
                                               {.unit = "B"}),
    row<&Store::max_folder_size>("folder_size", {}, 1024, most_memory, {.unit = "B"}),
    row<&Passwords::min_name_length>("min_name_length", {}, 1, 64, {.figure = {23}}),
    row<&Passwords::max_name_length>("max_name_length", {}, 1, 1'000,
                                     {.unit = "B", .figure = {24}}),
    row<&Passwords::min_password_length>("min_password_length", {}, 1, 64, {.figure = {25}}),
    row<&Passwords::max_password_length>("max_password_length", {}, 1, 1'000,
                                         {.unit = "B", .figure = {26}}),
    row<&Passwords::max_users>("users", {}, 1, most_elements, {.figure = {22}}),
    row<&ControllerConfig::port>("port", {}, 0, 65'535, {.table = "server"}),
    row<&DiscoveryConfig::interval>("interval_s", {}, 10, 600), // Part 4, 5.5.5.1
    row<&CertificateConfig::key_bits>("key_bits", {}, 2'048, 4'096, {.unit = "bit"}),
    row<&CertificateConfig::valid_days>("valid_days", {}, 1, 36'525, {.unit = "d"}), // a century
    row<&Log::files>("execution_log_files", {}, 2, 100),
    row<&Log::records>("execution_log_records", {}, 100, 65'536),
    row<&MachineConfig::retained>("retained_ms", {}, 100, 3'600'000),
    row<&Labels::access_unit>("access_unit", {}, 0, most_points),
    row<&Labels::max_waiting>("waiting", {}, 1, 100'000),
    row<&Labels::max_sampled_points>("sampled_points", {}, 1, most_points),
    row<&LabelConfig::call_limit>("call_limit_ms", {}, 10, 60'000),
    row<&ControllerConfig::scan>("scan_ms", {}, 1, 10'000),
    row<&ControllerConfig::realtime_priority>("realtime_priority", {}, 0, 99),
    row<&server::ImageOptions::max_queued_scans>("queued_scans", {}, 1, 1'000),
    row<&server::ImageOptions::max_waiting_writes>("waiting_writes", {}, 1, 100'000),
};

} // namespace

std::span<const LimitKey> limit_keys()
{
    return keys;
}

std::vector<const LimitKey*> limits_in(LimitEntry LimitKey::*document)
{
    std::vector<const LimitKey*> found;
    for (const LimitKey& key : keys) {
        if ((key.*document).place != 0) {
            found.push_back(&key);
        }
    }
    std::ranges::sort(found, {}, [&](const LimitKey* key) { return (key->*document).place; });
    return found;
}

std::string setting_name(const LimitKey& key)
{
    return std::string{key.table} + "." + std::string{key.name};
}

namespace {

/// Splits a key into table and name, for fast look-up: a new Settings object looks up every
/// setting.
std::pair<std::string_view, std::string_view> place_of(const LimitKey* key)
{
    return {key->table, key->name};
}

} // namespace

const LimitKey* find_limit(std::string_view setting)
{
    static const auto sorted = [] {
        std::array<const LimitKey*, std::size(keys)> all{};
        std::ranges::transform(keys, all.begin(), [](const LimitKey& key) { return &key; });
        std::ranges::sort(all, {}, place_of);
        return all;
    }();
    const std::size_t point = setting.rfind('.');
    if (point == std::string_view::npos) {
        return nullptr;
    }
    const std::pair place{setting.substr(0, point), setting.substr(point + 1)};
    const auto found = std::ranges::lower_bound(sorted, place, {}, place_of);
    return found == sorted.end() || place_of(*found) != place ? nullptr : *found;
}

std::string key_of(std::string_view cost)
{
    constexpr std::string_view root = "limits.";
    const auto* const found =
        std::ranges::find_if(keys, [&](const LimitKey& key) { return key.cost == cost; });
    return found == std::end(keys) || cost.empty() ? std::string{}
                                                   : setting_name(*found).substr(root.size());
}

void read_numbers(const TomlTable& table, std::string_view path, ControllerConfig& config)
{
    for (const LimitKey& key : keys) {
        if (key.table == path && table.has(key.name)) {
            key.set(config, table.integer(key.name, 0, key.least, key.most));
        }
    }
}

} // namespace busbar::product
