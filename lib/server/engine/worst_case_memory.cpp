#include <busbar/server/worst_case_memory.hpp>

#include <algorithm>
#include <bit>
#include <limits>

#include <busbar/crypto/password_hash.hpp>
#include <busbar/server/process_image.hpp>
#include <busbar/server/server.hpp>
#include <busbar/types/monitored_item.hpp>
#include <busbar/types/node_management.hpp>

#include "channel/buffer_bounds.hpp"
#include "peer_link.hpp"
#include "server/attribute/read_job.hpp"
#include "server/attribute/write_job.hpp"
#include "server/image/structure_values.hpp"
#include "server/method/call_job.hpp"
#include "server/session/session.hpp"
#include "server/subscription/subscription.hpp"
#include "server/view/view_context.hpp"

namespace busbar::server {

namespace {

using Number = std::uint64_t;
constexpr Number most = std::numeric_limits<Number>::max();

Number times(Number a, Number b)
{
    return b != 0 && a > most / b ? most : a * b;
}

Number plus(Number a, Number b)
{
    return a > most - b ? most : a + b;
}

// Memory of objects that are not measured by the code which creates them, with everything that
// belongs to them; a test fills each and measures it.

constexpr Number bytes_of_text = 288; // CreateSession shortens them to this
/// Factor of an OpenSSL object's size over the size of its DER.
constexpr Number parsed_certificate = 3;
constexpr Number bytes_of_certificate = 16'384 * parsed_certificate;
constexpr Number bytes_of_chain = crypto::max_chain_size * parsed_certificate;
/// Ciphers of three SecurityTokens, endpoint URL, nonces.
constexpr Number bytes_of_channel = 16'384;
constexpr Number bytes_of_operation = 2'048;
/// The Object of a session below SessionsDiagnosticsSummary, with its Variables.
constexpr Number bytes_of_diagnostics = 65'536;
/// Including 32 nodes of its diagnostics.
constexpr Number bytes_of_subscription = 2'048 + 32 * 256;
constexpr Number bytes_of_kept_message = 64; // without the message
constexpr Number bytes_of_status_change = 256;
constexpr Number bytes_of_locale = 64;
constexpr Number bytes_of_client_node = 256; // without the node
constexpr Number bytes_of_client_reference = 512;
constexpr Number bytes_of_event = sizeof(Event) + 64;
constexpr Number bytes_of_notifier = 64;
constexpr Number bytes_of_login_entry = 4'096;
constexpr Number bytes_of_channel_entry = 512;
/// Names of a node in a ReferenceDescription.
constexpr Number bytes_of_names = 1'024;
/// Password checks that a Worker lets wait.
constexpr Number waiting_checks = 64;

constexpr std::string_view by_session = "paid for by max_session_memory";
constexpr std::string_view by_subscription = "paid for by subscriptions.max_subscription_memory";

/// Creates the rows, each for the limit that was named last.
class Rows {
public:
    explicit Rows(std::vector<MemoryRow>& rows) : rows_{rows} {}

    Rows& count(std::string_view name, Number value) { return name_next(name, value, {}); }
    Rows& bytes(std::string_view name, Number value)
    {
        return name_next(name, value, LimitUnit::Bytes);
    }
    Rows& time(std::string_view name, Duration value)
    {
        const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(value).count();
        return name_next(name, static_cast<Number>(whole), LimitUnit::Milliseconds);
    }
    Rows& holds(Number count, Number each, std::string_view what)
    {
        if (has_row_) {
            rows_.push_back({rows_.back().limit, rows_.back().value, rows_.back().unit, 0, 0, {}});
        }
        has_row_ = true;
        rows_.back().count = count;
        rows_.back().bytes_each = each;
        rows_.back().held = what;
        return *this;
    }
    void paid(std::string_view by) { rows_.back().held = by; }

private:
    Rows& name_next(std::string_view name, Number value, LimitUnit unit)
    {
        rows_.push_back({name, value, unit, 0, 0, {}});
        has_row_ = false;
        return *this;
    }

    std::vector<MemoryRow>& rows_;
    bool has_row_{false};
};

/// Connections whose last bytes wait for their peers exist in addition to open ones.
Number all_connections(const ServerLimits& limits)
{
    return times(2, limits.max_connections);
}

void add_transport(Rows& rows, const ServerLimits& limits)
{
    const channel::TransportLimits all = channel::detail::completed(limits.transport);
    const auto bounds = channel::detail::bounds_of(all, limits.max_send_queue);
    const Number connections = all_connections(limits);
    rows.bytes("transport.receive_buffer_size", all.receive_buffer_size)
        .holds(connections, bounds.input, "bytes that came, until they are a chunk");
    rows.bytes("transport.send_buffer_size", all.send_buffer_size).paid("see max_send_queue");
    rows.bytes("transport.max_message_size", all.max_message_size)
        .holds(1, bounds.shared, "buffers that connections use in turn")
        .holds(1, times(2, all.max_message_size), "the request that is served")
        .holds(1, detail::Core::kept_bytes(limits), "memory that large requests use in turn");
    rows.count("transport.max_chunk_count", all.max_chunk_count);
    rows.time("transport.handshake_timeout", all.handshake_timeout);
}

void add_decode(Rows& rows, const ServerLimits& limits)
{
    const binary::DecodeLimits& decode = limits.decode;
    const Number message = channel::detail::completed(limits.transport).max_message_size;
    rows.bytes("decode.max_string_length", decode.max_string_length)
        .holds(waiting_checks, std::min<Number>(decode.max_string_length, message),
               "names of users whose passwords wait for a worker");
    rows.bytes("decode.max_byte_string_length", decode.max_byte_string_length);
    rows.count("decode.max_array_length", decode.max_array_length);
    rows.count("decode.max_depth", decode.max_depth);
    rows.count("decode.max_diagnostic_depth", decode.max_diagnostic_depth);
    rows.count("decode.max_expansion", decode.max_expansion)
        .holds(decode.max_expansion, message, "objects of the request that is served");
    rows.bytes("decode.free_memory", decode.free_memory)
        .holds(1, decode.free_memory, "the same of a small request");
}

/// For the request that is being served; a waiting one is paid for by its session.
void add_operations(Rows& rows, const ServerLimits& limits)
{
    const OperationLimits& operations = limits.operations;
    constexpr std::string_view results = "operations and results of the request that is served";
    const auto add = [&](std::string_view name, Number count, Number each) {
        rows.count(name, count).holds(count, each, results);
    };
    add("operations.max_nodes_per_read", operations.max_nodes_per_read,
        detail::ReadJob::bytes_per_item);
    add("operations.max_nodes_per_write", operations.max_nodes_per_write,
        detail::WriteJob::bytes_per_item);
    add("operations.max_nodes_per_browse", operations.max_nodes_per_browse, sizeof(BrowseResult));
    add("operations.max_nodes_per_register_nodes", operations.max_nodes_per_register_nodes,
        sizeof(NodeId) + bytes_of_text);
    add("operations.max_nodes_per_translate_browse_paths",
        operations.max_nodes_per_translate_browse_paths, sizeof(BrowsePathResult));
    add("operations.max_nodes_per_method_call", operations.max_nodes_per_method_call,
        bytes_of_operation);
    add("operations.max_nodes_per_node_management", operations.max_nodes_per_node_management,
        sizeof(AddNodesResult) + bytes_of_text);
    add("operations.max_monitored_items_per_call", operations.max_monitored_items_per_call,
        sizeof(MonitoredItemCreateResult));
}

void add_connections(Rows& rows, const ServerLimits& limits)
{
    const auto bounds = channel::detail::bounds_of(limits.transport, limits.max_send_queue);
    rows.count("max_connections", limits.max_connections)
        .holds(all_connections(limits),
               sizeof(detail::PeerLink) + bytes_of_channel + bytes_of_chain,
               "connections, the closed ones that still send included")
        .holds(crypto::KnownCertificates::max_count,
               crypto::KnownCertificates::max_size * parsed_certificate,
               "certificates of the peers that came last");
    rows.count("max_connections_per_address", limits.max_connections_per_address);
    rows.time("sessionless_timeout", limits.sessionless_timeout);
    rows.bytes("max_sessionless_message", limits.max_sessionless_message);
    // A growing buffer exists twice.
    rows.bytes("max_send_queue", limits.max_send_queue)
        .holds(plus(all_connections(limits), 1), bounds.output,
               "answers that wait for a peer, with one message more");
    rows.time("send_timeout", limits.send_timeout);
    rows.count("max_pending_requests", limits.max_pending_requests)
        .holds(times(limits.max_connections, limits.max_pending_requests), bytes_of_operation,
               "requests that wait, without their messages");
    rows.bytes("max_assembly", limits.max_assembly)
        .holds(2, limits.max_assembly, "unfinished messages, in buffers that double");
    rows.time("min_token_lifetime", limits.min_token_lifetime);
    rows.time("max_token_lifetime", limits.max_token_lifetime);
}

void add_sessions(Rows& rows, const ServerLimits& limits)
{
    constexpr Number texts = 16;
    rows.count("max_sessions", limits.max_sessions)
        .holds(limits.max_sessions,
               sizeof(detail::Session) + texts * bytes_of_text + bytes_of_certificate +
                   bytes_of_diagnostics,
               "sessions with their certificates and diagnostics");
    rows.count("max_sessions_per_user", limits.max_sessions_per_user);
    rows.count("max_sessions_per_channel", limits.max_sessions_per_channel);
    rows.time("min_session_timeout", limits.min_session_timeout);
    rows.time("max_session_timeout", limits.max_session_timeout);
    rows.time("activation_timeout", limits.activation_timeout);
    rows.bytes("max_session_memory", limits.max_session_memory)
        .holds(limits.max_sessions, limits.max_session_memory,
               "waiting requests and their results so far, continuation points");
    rows.count("max_locale_ids", limits.max_locale_ids)
        .holds(times(limits.max_sessions + limits.subscriptions.max_subscriptions,
                     limits.max_locale_ids),
               bytes_of_locale,
               "locales of sessions, and of Subscriptions whose session has ended");
}

void add_services(Rows& rows, const ServerLimits& limits)
{
    const auto& operations = limits.operations;
    const Number in_a_turn = detail::Turn::units / detail::Turn::units_of_reference + 1;
    const auto in_all = [](Number nodes, Number each) {
        return std::min<Number>(times(nodes, each), detail::ViewContext::max_references);
    };
    rows.count("max_browse_continuation_points", limits.max_browse_continuation_points)
        .paid(by_session);
    rows.count("max_references_per_node", limits.max_references_per_node)
        .holds(std::min(in_a_turn,
                        in_all(operations.max_nodes_per_browse, limits.max_references_per_node)),
               sizeof(ReferenceDescription) + bytes_of_names,
               "references found in one turn; what waits is paid for by the session");
    rows.count("max_browse_path_elements", limits.max_browse_path_elements);
    rows.count("max_browse_path_targets", limits.max_browse_path_targets)
        .holds(
            in_all(operations.max_nodes_per_translate_browse_paths, limits.max_browse_path_targets),
            sizeof(BrowsePathTarget), "targets found in one turn");
    rows.count("max_client_nodes", limits.max_client_nodes)
        .holds(limits.max_client_nodes, bytes_of_client_node, "bookkeeping of clients' nodes");
    rows.count("max_client_references", limits.max_client_references)
        .holds(limits.max_client_references, bytes_of_client_reference,
               "references that clients have added");
    rows.bytes("max_client_node_memory", limits.max_client_node_memory)
        .holds(1, limits.max_client_node_memory, "nodes that clients have added");
}

void add_events(Rows& rows, const EventLimits& limits)
{
    rows.count("events.filter.max_select_clauses", limits.filter.max_select_clauses)
        .paid(by_subscription);
    rows.count("events.filter.max_elements", limits.filter.max_elements).paid(by_subscription);
    rows.count("events.filter.max_operands", limits.filter.max_operands).paid(by_subscription);
    rows.count("events.filter.max_path_elements", limits.filter.max_path_elements)
        .paid(by_subscription);
    rows.bytes("events.filter.max_literal_size", limits.filter.max_literal_size)
        .paid(by_subscription);
    const Number raised = std::clamp<Number>(limits.max_raised_events, 2, Number{1} << 62U);
    rows.count("events.max_raised_events", limits.max_raised_events)
        .holds(std::bit_ceil(raised), bytes_of_event,
               "places for raised events, from the beginning");
    rows.count("events.max_notifiers", limits.max_notifiers)
        .holds(limits.max_notifiers, bytes_of_notifier, "notifiers that an event reaches");
}

void add_items(Rows& rows, const SubscriptionLimits& limits)
{
    rows.count("subscriptions.max_subscriptions_per_session", limits.max_subscriptions_per_session);
    rows.count("subscriptions.max_subscriptions_per_user", limits.max_subscriptions_per_user);
    rows.count("subscriptions.max_subscriptions", limits.max_subscriptions)
        .holds(limits.max_subscriptions,
               sizeof(detail::Subscription) + sizeof(detail::SubscriptionOwner) +
                   bytes_of_subscription,
               "Subscriptions without their items");
    rows.count("subscriptions.max_items_per_subscription", limits.max_items_per_subscription)
        .paid(by_subscription);
    rows.count("subscriptions.max_items_per_user", limits.max_items_per_user).paid(by_subscription);
    rows.count("subscriptions.max_items", limits.max_items).paid(by_subscription);
    rows.count("subscriptions.max_triggering_links", limits.max_triggering_links)
        .paid(by_subscription);
    rows.time("subscriptions.min_publishing_interval", limits.min_publishing_interval);
    rows.time("subscriptions.max_publishing_interval", limits.max_publishing_interval);
    rows.time("subscriptions.min_keep_alive", limits.min_keep_alive);
    rows.time("subscriptions.max_keep_alive", limits.max_keep_alive);
    rows.time("subscriptions.min_lifetime", limits.min_lifetime);
    rows.time("subscriptions.max_lifetime", limits.max_lifetime);
    rows.count("subscriptions.max_notifications_per_publish", limits.max_notifications_per_publish);
    rows.count("subscriptions.max_queue_size", limits.max_queue_size).paid(by_subscription);
    rows.count("subscriptions.max_event_queue_size", limits.max_event_queue_size)
        .paid(by_subscription);
    rows.time("subscriptions.sampling.min_interval", limits.sampling.min_interval);
    rows.time("subscriptions.sampling.max_interval", limits.sampling.max_interval);
}

void add_publishing(Rows& rows, const ServerLimits& all)
{
    const SubscriptionLimits& limits = all.subscriptions;
    rows.count("subscriptions.max_publish_requests", limits.max_publish_requests).paid(by_session);
    rows.count("subscriptions.max_acknowledgements", limits.max_acknowledgements).paid(by_session);
    rows.count("subscriptions.max_retransmission_messages", limits.max_retransmission_messages)
        .holds(times(limits.max_subscriptions, limits.max_retransmission_messages),
               bytes_of_kept_message, "messages kept for Republish, without their bytes");
    rows.bytes("subscriptions.max_message_size", limits.max_message_size)
        .holds(2, limits.max_message_size, "the message that is written");
    rows.count("subscriptions.max_status_changes", limits.max_status_changes)
        .holds(times(all.max_sessions, limits.max_status_changes), bytes_of_status_change,
               "StatusChangeNotifications that wait");
    rows.bytes("subscriptions.max_subscription_memory", limits.max_subscription_memory)
        .paid("paid for by subscriptions.max_memory");
    rows.bytes("subscriptions.max_memory", limits.max_memory)
        .holds(1, limits.max_memory, "items, queued values, messages kept for Republish");
}

void add_logins(Rows& rows, const ServerLimits& limits, const MemoryAssumptions& other)
{
    rows.count("max_login_failures", limits.max_login_failures);
    rows.count("max_login_failures_per_source", limits.max_login_failures_per_source);
    rows.time("login_lock", limits.login_lock);
    rows.time("first_login_delay", limits.first_login_delay);
    rows.time("max_login_delay", limits.max_login_delay);
    rows.count("max_channel_burst", limits.max_channel_burst);
    rows.time("channel_interval", limits.channel_interval);
    rows.count("max_channel_failures", limits.max_channel_failures);
    rows.time("failed_channel_interval", limits.failed_channel_interval);
    rows.time("max_channel_delay", limits.max_channel_delay);
    rows.count("max_channel_entries", limits.max_channel_entries)
        .holds(limits.max_channel_entries, bytes_of_channel_entry,
               "addresses whose OpenSecureChannels are rationed");
    rows.count("max_log_lines_per_minute", limits.max_log_lines_per_minute);
    rows.count("max_login_entries", limits.max_login_entries)
        .holds(std::max<Number>(limits.max_login_entries, 1), bytes_of_login_entry,
               "clients and users that failed or logged in");
    const Number password = crypto::memory_of(other.password_cost);
    rows.bytes("MemoryAssumptions::password_cost", password)
        .holds(other.password_checks, password, "passwords that are being checked");
    if (other.has_channel_worker) {
        const channel::TransportLimits all = channel::detail::completed(limits.transport);
        rows.count("MemoryAssumptions::has_channel_worker", 1)
            .holds(limits.max_connections,
                   plus(all.receive_buffer_size, times(2, all.send_buffer_size)),
                   "OpenSecureChannels that are with a worker");
    }
}

/// A batch stays with a slow source when its request has long timed out.
void add_sources(Rows& rows, const ServerLimits& limits, const MemoryAssumptions& other)
{
    const Number message = channel::detail::completed(limits.transport).max_message_size;
    const Number request =
        plus(times(message, Number{2} + limits.decode.max_expansion), limits.decode.free_memory);
    const OperationLimits& operations = limits.operations;
    const Number in_a_batch =
        std::max({operations.max_nodes_per_read, operations.max_nodes_per_write,
                  operations.max_nodes_per_method_call});
    for (const DataSourceOptions& source : other.slow_sources) {
        rows.count("DataSourceOptions::max_batches", source.max_batches)
            .holds(source.max_batches, request, "requests that a source has not completed");
        rows.count("DataSourceOptions::max_items", source.max_items)
            .holds(std::min<Number>(source.max_items, times(source.max_batches, in_a_batch)),
                   detail::WriteJob::bytes_per_item, "the items of these");
    }
}

void add_driver(Rows& rows, const ServerLimits& limits, const MemoryAssumptions& other)
{
    rows.bytes("MemoryAssumptions::connection_bytes", other.connection_bytes)
        .holds(all_connections(limits), other.connection_bytes,
               "what drives the server holds for connections");
}

void add_images(Rows& rows, const MemoryAssumptions& other)
{
    for (const ProcessImage* const image : other.images) {
        Number each = 0;
        for (std::uint32_t handle = 0; handle < image->size(); ++handle) {
            each = plus(each, detail::StructureValues::max_bytes(image->place(handle)));
        }
        const Number waiting = image->options().max_waiting_bytes;
        rows.bytes("ImageOptions::max_waiting_bytes", waiting)
            .holds(1, waiting, "Write requests that wait for a scan's edge");
        rows.count("ImageOptions::max_pins", image->options().max_pins);
        if (each != 0) {
            // And the scan that items are sampled from.
            rows.holds(Number{image->options().max_pins} + 1,
                       plus(each, detail::StructureValues::usual_block),
                       "structures on the wire, of scans that Reads and sampling hold");
        }
    }
}

} // namespace

std::uint64_t MemoryRow::bytes() const
{
    return times(count, bytes_each);
}

std::uint64_t WorstCaseMemory::total() const
{
    Number sum = 0;
    for (const MemoryRow& row : rows) {
        sum = plus(sum, row.bytes());
    }
    return sum;
}

WorstCaseMemory worst_case_memory(const ServerLimits& limits, const MemoryAssumptions& other)
{
    WorstCaseMemory all;
    Rows rows{all.rows};
    add_transport(rows, limits);
    add_decode(rows, limits);
    add_operations(rows, limits);
    add_connections(rows, limits);
    add_sessions(rows, limits);
    add_services(rows, limits);
    add_events(rows, limits.events);
    add_items(rows, limits.subscriptions);
    add_publishing(rows, limits);
    add_logins(rows, limits, other);
    add_sources(rows, limits, other);
    add_images(rows, other);
    if (other.connection_bytes != 0) {
        add_driver(rows, limits, other);
    }
    return all;
}

WorstCaseMemory Server::worst_case_memory(const ServerLimits& limits)
{
    return server::worst_case_memory(limits);
}

} // namespace busbar::server
