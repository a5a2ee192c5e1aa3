#pragma once

#include <busbar/core/types.hpp>

namespace busbar::client::detail {

/// Returns the ReferenceType of namespace 0 with this BrowseName; null if it is not a common one.
[[nodiscard]] NodeId standard_reference_type(const QualifiedName& name);
/// Returns the BrowseName of such a ReferenceType; empty if it is not one of them.
[[nodiscard]] QualifiedName standard_name(const NodeId& reference_type);

} // namespace busbar::client::detail
