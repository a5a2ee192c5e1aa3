#pragma once

#include <string>
#include <string_view>

#include <busbar/core/refusal.hpp>

namespace busbar::channel::detail {

/// What the operator reads of an error of the protocol that is known by its status alone: framing,
/// tokens, sequence numbers.
[[nodiscard]] Refusal protocol_refusal(StatusCode status);

} // namespace busbar::channel::detail
