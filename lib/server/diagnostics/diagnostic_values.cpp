#include "diagnostic_values.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_set>
#include <vector>

#include <busbar/types/ids.hpp>

#include "describe.hpp"
#include "server/session/session.hpp"
#include "server/subscription/sampler.hpp"
#include "server/subscription/subscription.hpp"

namespace busbar::server::detail {

namespace {

using Summary = ServerDiagnosticsSummaryDataType;

/// Returns a list of structures.
template <typename Range, typename Describe>
Variant structures(const Range& range, Describe describe)
{
    Array<ExtensionObject> all(0);
    for (const auto& entry : range) {
        all.push_back(ExtensionObject::from(describe(*entry.second)));
    }
    return all;
}

/// Counts Views below the folder of Views, up to a reasonable depth.
std::uint32_t count_views(const model::AddressSpace& space)
{
    constexpr std::size_t most = 1'000;
    std::vector<model::NodeIndex> open{space.find(id::ViewsFolder)};
    std::unordered_set<model::NodeIndex> seen{open.front()};
    std::uint32_t views = 0;
    while (!open.empty()) {
        const model::NodeIndex node = open.back();
        open.pop_back();
        views += space.node_class(node) == NodeClass::View ? 1U : 0U;
        model::ReferenceCursor cursor = space.references(node);
        while (seen.size() < most) {
            const auto reference = cursor.next();
            if (!reference) {
                break;
            }
            if (reference->is_forward && space.is_subtype_of(reference->type, id::Organizes) &&
                seen.insert(reference->target).second) {
                open.push_back(reference->target);
            }
        }
    }
    return views;
}

Summary summarise(const DiagnosticsNeeds& needs)
{
    Summary summary = needs.counters.summary;
    summary.current_session_count = count(needs.sessions.size());
    summary.current_subscription_count = count(needs.subscriptions.size());
    std::set<Duration> intervals;
    for (const auto& [id, subscription] : needs.subscriptions.all()) {
        intervals.insert(subscription->parameters().publishing_interval);
    }
    summary.publishing_interval_count = count(intervals.size());
    return summary;
}

Summary with_views(const DiagnosticsNeeds& needs)
{
    Summary summary = summarise(needs);
    summary.server_view_count = count_views(needs.space);
    return summary;
}

/// Part 5, 12.8: only for a server with a fixed set of intervals (Part 5, 6.3.3).
Variant sampling_intervals(const DiagnosticsNeeds& needs)
{
    Array<ExtensionObject> all(0);
    for (const auto& [interval, items] : needs.subscriptions.sampler().intervals().all()) {
        if (items.enabled + items.disabled != 0) {
            SamplingIntervalDiagnosticsDataType entry;
            entry.sampling_interval = to_milliseconds(interval);
            entry.monitored_item_count = count(items.enabled + items.disabled);
            entry.max_monitored_item_count = count(items.most);
            entry.disabled_monitored_item_count = count(items.disabled);
            all.push_back(ExtensionObject::from(entry));
        }
    }
    return all;
}

constexpr std::uint32_t view_count =
    id::Server_ServerDiagnostics_ServerDiagnosticsSummary_ServerViewCount;

struct SummaryCounter {
    std::uint32_t id;
    std::uint32_t Summary::*counter;
};

/// Components of the ServerDiagnosticsSummary (Part 5, 7.8).
constexpr std::array summary_counters{
    SummaryCounter{view_count, &Summary::server_view_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSessionCount,
                   &Summary::current_session_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CumulatedSessionCount,
                   &Summary::cumulated_session_count},
    SummaryCounter{
        id::Server_ServerDiagnostics_ServerDiagnosticsSummary_SecurityRejectedSessionCount,
        &Summary::security_rejected_session_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_RejectedSessionCount,
                   &Summary::rejected_session_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_SessionTimeoutCount,
                   &Summary::session_timeout_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_SessionAbortCount,
                   &Summary::session_abort_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_PublishingIntervalCount,
                   &Summary::publishing_interval_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CurrentSubscriptionCount,
                   &Summary::current_subscription_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_CumulatedSubscriptionCount,
                   &Summary::cumulated_subscription_count},
    SummaryCounter{
        id::Server_ServerDiagnostics_ServerDiagnosticsSummary_SecurityRejectedRequestsCount,
        &Summary::security_rejected_requests_count},
    SummaryCounter{id::Server_ServerDiagnostics_ServerDiagnosticsSummary_RejectedRequestsCount,
                   &Summary::rejected_requests_count},
};

/// Returns the structures; fails for other nodes.
Result<Variant> structure_value(const DiagnosticsNeeds& needs, std::uint32_t id,
                                const ReadingUser& reader)
{
    switch (id) {
    case id::Server_ServerDiagnostics_ServerDiagnosticsSummary:
        return ExtensionObject::from(with_views(needs));
    case id::Server_ServerDiagnostics_SubscriptionDiagnosticsArray:
        return structures(needs.subscriptions.all(), [&](const Subscription& subscription) {
            return describe_subscription(needs.counters, subscription);
        });
    case id::Server_ServerDiagnostics_SamplingIntervalDiagnosticsArray:
        return sampling_intervals(needs);
    case id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionDiagnosticsArray:
        return structures(needs.sessions.all(), [&](const Session& session) {
            return describe_session(needs.counters, session);
        });
    case id::Server_ServerDiagnostics_SessionsDiagnosticsSummary_SessionSecurityDiagnosticsArray:
        if (!reader.may_see_security()) {
            return fail(status::Bad_UserAccessDenied);
        }
        return structures(needs.sessions.all(), describe_security);
    default:
        return fail(status::Bad_NodeIdUnknown);
    }
}

/// Fails for nodes that are not among these.
Result<Variant> diagnostic_value(const DiagnosticsNeeds& needs, std::uint32_t id,
                                 const ReadingUser& reader)
{
    const auto* const counter =
        std::find_if(summary_counters.begin(), summary_counters.end(),
                     [id](const SummaryCounter& entry) { return entry.id == id; });
    const bool is_counter = counter != summary_counters.end();
    const auto summary = id == view_count ? with_views : summarise;
    auto value = is_counter ? Result<Variant>{summary(needs).*counter->counter}
                            : structure_value(needs, id, reader);
    const bool is_ours = value || value.error() != status::Bad_NodeIdUnknown;
    if (is_ours && !needs.counters.is_enabled()) {
        return fail(status::Bad_NotReadable); // Part 5, 6.3.3
    }
    return value;
}

} // namespace

DataValue DiagnosticValues::session_value(const NodeId& node, const ReadingUser& reader) const
{
    const model::NodeIndex index = needs_.space.find(node);
    auto value = session_nodes_.value(needs_.space.variable(index).handle, reader);
    return value ? DataValue{std::move(*value), status::Good, needs_.wall_clock.now()}
                 : DataValue{value.error()};
}

Result<DataValue> DiagnosticValues::find(const NodeId& node, const ReadingUser& reader) const
{
    if (node.namespace_index() != 0) {
        return session_value(node, reader);
    }
    if (!node.is_numeric()) {
        return fail(status::Bad_NodeIdUnknown);
    }
    auto value = diagnostic_value(needs_, node.numeric(), reader);
    if (!value && value.error() != status::Bad_NodeIdUnknown) {
        return DataValue{value.error()};
    }
    return std::move(value).transform([&](Variant present) {
        return DataValue{std::move(present), status::Good, needs_.wall_clock.now()};
    });
}

} // namespace busbar::server::detail
