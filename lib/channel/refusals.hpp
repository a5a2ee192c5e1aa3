#pragma once

#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>
#include <busbar/core/result.hpp>

namespace busbar::channel::detail {

/// Returns the operator's explanation of a protocol error that is known by its status alone:
/// framing, tokens, sequence numbers.
[[nodiscard]] Refusal protocol_refusal(StatusCode status);

/// The one answer to every error of a signature, padding or encrypted size, so that a peer cannot
/// tell them apart.
[[nodiscard]] inline auto security_failure()
{
    return fail(status::Bad_SecurityChecksFailed);
}

} // namespace busbar::channel::detail
