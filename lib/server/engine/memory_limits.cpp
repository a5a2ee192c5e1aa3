#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <busbar/server/worst_case_memory.hpp>

// Limits for a machine's memory: between those of a small controller and the defaults.

namespace busbar::server {

namespace {

/// Number of proportions that are tried.
constexpr unsigned steps = 1'024;

/// Returns a number in a geometric proportion between the two, so that a limit that is not above
/// another one in both is not above it in between. A limit of 0 grows linearly instead.
template <typename Number>
Number between(Number small, Number large, unsigned step)
{
    const double share = static_cast<double>(step) / steps;
    const auto from = static_cast<double>(small);
    const auto to = static_cast<double>(large);
    const double value = small == 0 ? share * to : from * std::pow(to / from, share);
    return std::clamp(static_cast<Number>(value), std::min(small, large), std::max(small, large));
}

/// Sets members of `limits`, which are the large ones, to numbers in between.
template <typename Limits, typename Number, std::size_t Count>
void mix(Limits& limits, const Limits& small, unsigned step,
         const std::array<Number Limits::*, Count>& members)
{
    for (Number Limits::*const member : members) {
        limits.*member = between(small.*member, limits.*member, step);
    }
}

void mix_messages(ServerLimits& limits, const ServerLimits& small, unsigned step)
{
    using Transport = channel::TransportLimits;
    mix(limits.transport, small.transport, step,
        std::array{&Transport::receive_buffer_size, &Transport::send_buffer_size,
                   &Transport::max_message_size, &Transport::max_chunk_count});
    using Decode = binary::DecodeLimits;
    mix(limits.decode, small.decode, step,
        std::array{&Decode::max_string_length, &Decode::max_byte_string_length,
                   &Decode::max_array_length, &Decode::free_memory});
    using Operations = OperationLimits;
    mix(limits.operations, small.operations, step,
        std::array{&Operations::max_nodes_per_read, &Operations::max_nodes_per_write,
                   &Operations::max_nodes_per_browse, &Operations::max_nodes_per_register_nodes,
                   &Operations::max_nodes_per_translate_browse_paths,
                   &Operations::max_nodes_per_method_call,
                   &Operations::max_nodes_per_node_management,
                   &Operations::max_monitored_items_per_call});
}

void mix_events(EventLimits& limits, const EventLimits& small, unsigned step)
{
    using Filter = EventFilterLimits;
    mix(limits.filter, small.filter, step,
        std::array{&Filter::max_select_clauses, &Filter::max_elements, &Filter::max_operands,
                   &Filter::max_path_elements, &Filter::max_literal_size});
    mix(limits, small, step,
        std::array{&EventLimits::max_raised_events, &EventLimits::max_notifiers});
}

void mix_subscriptions(SubscriptionLimits& limits, const SubscriptionLimits& small, unsigned step)
{
    using Limits = SubscriptionLimits;
    mix(limits, small, step,
        std::array{&Limits::max_subscriptions_per_session, &Limits::max_subscriptions_per_user,
                   &Limits::max_subscriptions, &Limits::max_items_per_subscription,
                   &Limits::max_items_per_user, &Limits::max_items, &Limits::max_triggering_links,
                   &Limits::max_publish_requests, &Limits::max_acknowledgements,
                   &Limits::max_retransmission_messages, &Limits::max_message_size,
                   &Limits::max_status_changes, &Limits::max_subscription_memory,
                   &Limits::max_memory});
    mix(limits, small, step,
        std::array{&Limits::max_notifications_per_publish, &Limits::max_queue_size,
                   &Limits::max_event_queue_size});
}

ServerLimits limits_at(unsigned step)
{
    const ServerLimits small = small_controller_limits();
    ServerLimits limits;
    mix_messages(limits, small, step);
    mix_events(limits.events, small.events, step);
    mix_subscriptions(limits.subscriptions, small.subscriptions, step);
    using Limits = ServerLimits;
    mix(limits, small, step,
        std::array{&Limits::max_connections, &Limits::max_connections_per_address,
                   &Limits::max_send_queue, &Limits::max_pending_requests, &Limits::max_assembly,
                   &Limits::max_sessions, &Limits::max_sessions_per_user,
                   &Limits::max_sessions_per_channel, &Limits::max_session_memory,
                   &Limits::max_locale_ids, &Limits::max_client_nodes,
                   &Limits::max_client_references, &Limits::max_client_node_memory,
                   &Limits::max_channel_entries, &Limits::max_login_entries});
    mix(limits, small, step,
        std::array{&Limits::max_sessionless_message, &Limits::max_references_per_node,
                   &Limits::max_browse_path_elements, &Limits::max_browse_path_targets});
    mix(limits, small, step, std::array{&Limits::max_browse_continuation_points});
    return limits;
}

} // namespace

Configured<ServerLimits> limits_for(std::uint64_t memory, const MemoryAssumptions& other)
{
    const auto needed = [&](unsigned step) {
        return worst_case_memory(limits_at(step), other).total();
    };
    if (const std::uint64_t least = needed(0); least > memory) {
        return misconfigured("memory", "found " + std::to_string(memory) +
                                           " bytes, expected at least " + std::to_string(least) +
                                           ", what small_controller_limits() needs");
    }
    unsigned fits = 0;
    for (unsigned beyond = steps + 1; beyond - fits > 1;) {
        const unsigned middle = (fits + beyond) / 2;
        (needed(middle) <= memory ? fits : beyond) = middle;
    }
    return limits_at(fits);
}

} // namespace busbar::server
