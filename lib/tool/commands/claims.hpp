#pragma once

#include "tool/connection/context.hpp"

namespace busbar::tool {

/// What a server says of itself (Part 5, 6.3.2): the profiles that it claims and, of those that it
/// does not, the conformance units that it does not name. Throws Failure.
[[nodiscard]] Exit show_claims(Context& context);

} // namespace busbar::tool
