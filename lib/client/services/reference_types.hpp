#pragma once

#include <busbar/core/types.hpp>

namespace busbar::client::detail {

/// The ReferenceType of namespace 0 with that BrowseName; null if it is none of the usual ones.
[[nodiscard]] NodeId standard_reference_type(const QualifiedName& name);
/// The BrowseName of such a ReferenceType; empty if it is none of them.
[[nodiscard]] QualifiedName standard_name(const NodeId& reference_type);

} // namespace busbar::client::detail
