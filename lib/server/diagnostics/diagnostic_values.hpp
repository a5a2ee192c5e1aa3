#pragma once

#include <cstdint>

#include "diagnostics_needs.hpp"
#include "server/rights/live_values.hpp"

namespace busbar::server::detail {

/// The value of a Variable below Server.ServerDiagnostics, i=2274; Bad_NodeIdUnknown for any other
/// node, Bad_NotReadable while diagnostics are off.
[[nodiscard]] Result<Variant> diagnostic_value(const DiagnosticsNeeds& needs, std::uint32_t id,
                                               const ReadingUser& reader);

} // namespace busbar::server::detail
