#pragma once

#include <string_view>

#include <busbar/core/record.hpp>

#include "peer.hpp"
#include "session.hpp"

/// Records of sessions.
namespace busbar::server::detail {

/// The result borrows from both.
[[nodiscard]] inline RecordActor actor_of(const Session& session, const RequestMark& mark)
{
    RecordActor actor{&session.id,
                      session.name,
                      session.client_application_uri,
                      session.user.name,
                      {},
                      mark.audit_entry_id,
                      mark.timestamp,
                      0};
    if (session.peer != nullptr) {
        actor.address = session.peer->address();
        actor.secure_channel_id = session.peer->channel().channel_id();
    }
    return actor;
}

[[nodiscard]] inline std::span<const std::byte> certificate_of(const Session& session)
{
    return session.client_certificate.empty() ? std::span<const std::byte>{}
                                              : session.client_certificate.front().der();
}

} // namespace busbar::server::detail
