#pragma once

#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>
#include <busbar/core/result.hpp>

namespace busbar::channel::detail {

/// What the operator reads of an error of the protocol that is known by its status alone: framing,
/// tokens, sequence numbers.
[[nodiscard]] Refusal protocol_refusal(StatusCode status);

/// The one answer to everything that is wrong with a signature, padding or encrypted size, so that
/// nobody learns which it was.
[[nodiscard]] inline auto security_failure()
{
    return fail(status::Bad_SecurityChecksFailed);
}

} // namespace busbar::channel::detail
