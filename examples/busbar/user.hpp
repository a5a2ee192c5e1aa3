#pragma once

#include <busbar/client/user_identity.hpp>

#include "context.hpp"

namespace busbar::cli {

/// Who the options log in. Asks for a password on a terminal if there is none; throws Failure.
[[nodiscard]] client::UserIdentity user_of(Context& context);

} // namespace busbar::cli
