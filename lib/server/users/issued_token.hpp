#pragma once

#include <busbar/types/session.hpp>

#include "user_token.hpp"

namespace busbar::server::detail {

/// Returns the user of an IssuedIdentityToken with a JSON Web Token (Part 4, 7.40.6; Part 6,
/// 6.5.2). Failures are those of begin_log_in.
[[nodiscard]] Login log_in_issued(const LoginContext& context, const IssuedIdentityToken& token);

} // namespace busbar::server::detail
