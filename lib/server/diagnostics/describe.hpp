#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

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

} // namespace busbar::server::detail
