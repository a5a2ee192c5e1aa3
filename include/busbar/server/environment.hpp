#pragma once

#include <busbar/channel/chunk_hook.hpp>
#include <busbar/channel/key_log.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/named_fields.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::server {

/// The services that a server needs from outside, set field by field: `{.random = &random,
/// .wall_clock = &clock, .log = &log, .users = &users}`. All must outlive the server.
/// Server::create names a required field that is null.
struct ServerEnvironment {
    [[no_unique_address]] NamedFields named_fields{};

    /// Required.
    crypto::Random* random{nullptr};
    /// Required.
    const WallClock* wall_clock{nullptr};
    /// Required; NullLog for none.
    LogSink* log{nullptr};
    /// Required unless every endpoint has policy None.
    crypto::CertificateValidator* validator{nullptr};
    /// Optional; if null, there are only anonymous users.
    UserStore* users{nullptr};
    /// Optional; if null, only the attributes of nodes restrict access.
    const AccessControl* access{nullptr};
    /// Optional; if null, users have only the roles that the UserStore gives them.
    const RoleMapper* roles{nullptr};
    /// Optional; null if every data source completes inline.
    Waker* waker{nullptr};
    /// Optional; if null, or without a Waker, the asymmetric work of OpenSecureChannel is done on
    /// the server's thread, which then does nothing else. A worker that has other work, such as
    /// passwords, delays channels by it; a separate net::WorkerThread does not.
    Worker* channel_worker{nullptr};
    /// Optional; null in every product. Builds without BUSBAR_KEY_LOG ignore it.
    channel::KeyLog* key_log{nullptr};
    /// Optional; null in every product.
    channel::ChunkHook* chunk_hook{nullptr};
};

} // namespace busbar::server
