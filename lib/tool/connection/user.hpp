#pragma once

#include <string>

#include <busbar/client/user_identity.hpp>
#include <busbar/crypto/secret.hpp>

#include "context.hpp"

namespace busbar::tool {

/// The user to log in, from the options. Asks for a missing password on a terminal; throws Failure.
[[nodiscard]] client::UserIdentity user_of(Context& context);

/// A password that `user` gets: the first line of `file`, or what is typed twice on a terminal.
/// Throws Failure.
[[nodiscard]] crypto::Secret new_password(Context& context, const std::string& user,
                                          const std::string& file);

} // namespace busbar::tool
