#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include <busbar/core/variant.hpp>
#include <busbar/types/data_types.hpp>

/// Describes sessions and Subscriptions as the diagnostics' structures.

namespace busbar::server::detail {

class Counters;
class Session;
class Subscription;

[[nodiscard]] inline std::uint32_t count(std::size_t value)
{
    return static_cast<std::uint32_t>(std::min<std::size_t>(value, UINT32_MAX));
}

[[nodiscard]] SessionDiagnosticsDataType describe_session(const Counters& counters,
                                                          const Session& session);
[[nodiscard]] SessionSecurityDiagnosticsDataType describe_security(const Session& session);
[[nodiscard]] SubscriptionDiagnosticsDataType
describe_subscription(const Counters& counters, const Subscription& subscription);
/// Returns an array for the session's Subscriptions.
[[nodiscard]] Variant describe_subscriptions(const Counters& counters, const Session& session);

// The fields of the diagnostics as single Variables (Part 5, 7.12, 7.15 and 7.17) have the fields'
// names as BrowseNames.

using FieldName = const char*;

[[nodiscard]] std::span<const FieldName> session_field_names();
/// Returns the field with this number, counted from 1; the whole structure for 0.
[[nodiscard]] Variant session_field(const SessionDiagnosticsDataType& session, std::size_t field);

[[nodiscard]] std::span<const FieldName> security_field_names();
[[nodiscard]] Variant security_field(const SessionSecurityDiagnosticsDataType& session,
                                     std::size_t field);

[[nodiscard]] std::span<const FieldName> subscription_field_names();
[[nodiscard]] Variant subscription_field(const SubscriptionDiagnosticsDataType& subscription,
                                         std::size_t field);

} // namespace busbar::server::detail
