#pragma once

#include "session_needs.hpp"

namespace busbar::server::detail {

/// Makes place for one session more from that address; another may end for it, which the log tells.
/// False if none can. See ServerLimits::max_sessions.
[[nodiscard]] bool make_session_place(const SessionNeeds& needs, std::string_view address);

/// Whether the user may have this session activated, over a channel from that address; another of
/// his may end for it. See ServerLimits::max_sessions_per_user.
[[nodiscard]] bool make_share(const SessionNeeds& needs, const Session& session,
                              const UserIdentity& user, std::string_view address);

} // namespace busbar::server::detail
