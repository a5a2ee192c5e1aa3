#pragma once

#include "tool/connection/context.hpp"

namespace busbar::tool {

/// Shows a server's claims (Part 5, 6.3.2): the profiles that it claims and, for the others, the
/// conformance units that it does not name. Throws Failure.
[[nodiscard]] Exit show_claims(Context& context);

} // namespace busbar::tool
