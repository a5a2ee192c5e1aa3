#pragma once

#include <busbar/core/types.hpp>

namespace busbar::client::detail {

/// The ReferenceType of namespace 0 with that BrowseName; null if it is none of the usual ones.
[[nodiscard]] NodeId standard_reference_type(const QualifiedName& name);

} // namespace busbar::client::detail
