#pragma once

#include "server/engine/core.hpp"
#include "server/rights/data_rights.hpp"
#include "service.hpp"
#include "session.hpp"

namespace busbar::server::detail {

/// What the user of the request's session may do over its channel.
[[nodiscard]] inline NodeRights rights_of(const ServiceContext& context)
{
    const Core& core = context.core;
    return {core.address_space, context.session->user, core.environment.access,
            context.session->security.mode};
}

} // namespace busbar::server::detail
