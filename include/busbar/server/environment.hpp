#pragma once

#include <busbar/channel/key_log.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/log.hpp>
#include <busbar/crypto/certificate_validator.hpp>
#include <busbar/crypto/random.hpp>
#include <busbar/server/access_control.hpp>
#include <busbar/server/waker.hpp>

namespace busbar::server {

/// What a server needs from outside; all must outlive it. Random, clock and log are never null.
struct ServerEnvironment {
    crypto::Random* random{nullptr};
    const WallClock* wall_clock{nullptr};
    LogSink* log{nullptr};
    /// May be null where every endpoint has policy None.
    crypto::CertificateValidator* validator{nullptr};
    /// Null: nobody but anonymous users.
    UserStore* users{nullptr};
    /// May be null.
    const AccessControl* access{nullptr};
    /// Null if every data source completes inline.
    Waker* waker{nullptr};
    /// Null in every product; builds without BUSBAR_KEY_LOG do not look at it.
    channel::KeyLog* key_log{nullptr};
};

} // namespace busbar::server
