#pragma once

#include <cstddef>
#include <span>

#include <busbar/core/variant.hpp>
#include <busbar/types/data_types.hpp>

/// The fields of the diagnostics as single Variables (Part 5, 7.12, 7.15 and 7.17), whose
/// BrowseNames are the fields' names.
namespace busbar::server::detail {

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
