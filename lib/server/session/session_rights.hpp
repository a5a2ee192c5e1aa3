#pragma once

#include "server/rights/node_rights.hpp"
#include "session.hpp"

namespace busbar::server::detail {

/// Returns the rights of the session's user over its channel; `access` may be null.
[[nodiscard]] inline NodeRights rights_of(const Session& session, const model::AddressSpace& space,
                                          const AccessControl* access)
{
    return {space, session.user, access, session.security.mode};
}

} // namespace busbar::server::detail
