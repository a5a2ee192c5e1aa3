#pragma once

#include "session_needs.hpp"

namespace busbar::server::detail {

/// Makes room for one more session from this address; another one may end for it, which is logged.
/// False if none can. See ServerLimits::max_sessions.
[[nodiscard]] bool make_session_place(const SessionNeeds& needs, std::string_view address);

/// Returns whether the user may activate this session, over a channel from this address; another
/// one of his may end for it. See ServerLimits::max_sessions_per_user.
[[nodiscard]] bool make_share(const SessionNeeds& needs, const Session& session,
                              const UserIdentity& user, std::string_view address);

} // namespace busbar::server::detail
