#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/binary/reader.hpp>
#include <busbar/channel/channel_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/detail/chrono.hpp>
#include <busbar/server/event_limits.hpp>
#include <busbar/server/subscription_limits.hpp>

namespace busbar::server {

/// The maximum number of operations in one request (Part 5, 6.3.11); more answer
/// Bad_TooManyOperations. Each is below DecodeLimits::max_array_length; otherwise a request with
/// one more could not be told from a malformed one.
struct OperationLimits {
    std::uint32_t max_nodes_per_read{65'535};
    std::uint32_t max_nodes_per_write{65'535};
    std::uint32_t max_nodes_per_browse{10'000};
    std::uint32_t max_nodes_per_register_nodes{10'000};
    std::uint32_t max_nodes_per_translate_browse_paths{10'000};
    std::uint32_t max_nodes_per_method_call{1'000};
    std::uint32_t max_nodes_per_node_management{1'000};
    /// Also limits the Subscriptions of a request that names several.
    std::uint32_t max_monitored_items_per_call{25'000};
};

/// Limits of everything that peers can make a server hold or do. All are finite.
struct ServerLimits {
    channel::TransportLimits transport;
    binary::DecodeLimits decode;
    OperationLimits operations;

    // Connections.

    std::size_t max_connections{120};
    std::size_t max_connections_per_address{60};
    /// A connection without an activated session is closed after this time; the oldest one is
    /// closed earlier if a new one needs its place (Part 4, 5.6.2.1): one of the same address, or
    /// of the network that has most. Only if all have sessions a new one is refused.
    std::chrono::milliseconds sessionless_timeout{30'000};
    /// Bytes of a request over a channel to which no activated session is bound. The waiting
    /// requests of one session may take 16 times as much, and max_session_memory once it is
    /// activated.
    std::uint32_t max_sessionless_message{64U << 10U};
    /// Bytes that may wait for a peer to take them, and the time after which a peer that takes none
    /// is dropped. While more than half of that waits, no requests are processed.
    std::size_t max_send_queue{32U << 20U};
    std::chrono::milliseconds send_timeout{30'000};
    /// Requests of one connection that wait for their answers; more answer Bad_ServerTooBusy.
    std::size_t max_pending_requests{100};
    /// Bytes that the unfinished messages of all connections may take together. Before less is left
    /// than one message may have, or a quarter, connections are closed: the one that holds most,
    /// from the network that holds most.
    std::size_t max_assembly{64U << 20U};
    /// Range of the lifetime of SecurityTokens.
    std::chrono::milliseconds min_token_lifetime{10'000};
    std::chrono::milliseconds max_token_lifetime{3'600'000};

    // Sessions.

    /// Beyond it a session gives way to the new one, or CreateSession answers Bad_TooManySessions:
    /// the oldest that was never activated (Part 4, 5.7.2.1), of the network that has most; else
    /// the oldest without a channel, of the user who has most and more than the new client's
    /// network.
    std::size_t max_sessions{100};
    /// Activated sessions of one user, or of the anonymous users of an IPv4 address or of the /64
    /// of an IPv6 address. Beyond it the user's oldest one without a channel gives way, or
    /// ActivateSession answers Bad_TooManySessions.
    std::size_t max_sessions_per_user{60};
    std::size_t max_sessions_per_channel{5};
    /// The requested timeout is limited to this range.
    std::chrono::milliseconds min_session_timeout{10'000};
    std::chrono::milliseconds max_session_timeout{3'600'000};
    /// Maximum time that a session may exist without ActivateSession.
    std::chrono::milliseconds activation_timeout{30'000};
    /// Bytes that continuation points, registered nodes, waiting requests and the like of one
    /// session may take.
    std::size_t max_session_memory{64U << 20U};
    std::size_t max_locale_ids{16};

    // Services.

    std::uint16_t max_browse_continuation_points{10};
    std::uint32_t max_references_per_node{10'000};
    std::uint32_t max_browse_path_elements{64};
    std::uint32_t max_browse_path_targets{1'000};
    /// Nodes and references added by clients that may exist at a time, of all clients together, and
    /// the bytes of the nodes. Removing them, by any client, makes room again.
    std::size_t max_client_nodes{10'000};
    std::size_t max_client_references{10'000};
    std::size_t max_client_node_memory{16U << 20U};
    EventLimits events;
    SubscriptionLimits subscriptions;

    // Logins (Part 4, 5.7.3.1): failures until a user is locked out at one client, failures until a
    // client is locked out for all users, and the time of the lock. See LoginGuard.

    std::size_t max_login_failures{5};
    std::size_t max_login_failures_per_source{20};
    std::chrono::milliseconds login_lock{300'000};
    /// A repeated failure is answered with this delay, each further one with twice the previous
    /// delay, up to the second value.
    std::chrono::milliseconds first_login_delay{250};
    std::chrono::milliseconds max_login_delay{4'000};

    // OpenSecureChannel with a policy other than None (Part 2, 5.1.2.2): the number that one
    // address may send at once, one more each interval; the time that one may wait for that before
    // it is refused with Bad_TcpServerTooBusy; the number of failures after which the address gets
    // the longer interval; the number of addresses that are remembered. Intervals of 0 mean no
    // limit. See ChannelGuard.

    std::size_t max_channel_burst{10};
    std::chrono::milliseconds channel_interval{50};
    std::size_t max_channel_failures{5};
    std::chrono::milliseconds failed_channel_interval{2'000};
    std::chrono::milliseconds max_channel_delay{5'000};
    std::size_t max_channel_entries{512};

    /// Lines that sessions may write to the log.
    std::size_t max_log_lines_per_minute{600};
    /// Clients and users that are remembered for failures, and pairs of both for successes.
    std::size_t max_login_entries{512};
};

/// Limits for a machine with little memory: a handful of clients with a thousand items. What peers
/// can make a server hold with these is below 16 MiB (see worst_case_memory); the time that each
/// password takes, and its memory (crypto::memory_of), are extra. With hashes of
/// crypto::PasswordScheme::Pbkdf2 that memory is negligible.
[[nodiscard]] BUSBAR_API ServerLimits small_controller_limits();

} // namespace busbar::server
