#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>

namespace busbar::channel {

/// Decides when a server does the asymmetric work of an OpenSecureChannel, which takes the server
/// milliseconds and the sender nothing (Part 2, 5.1.2.2). Asked before any of it is done; never
/// with policy None, which has none. Called on the channel's thread.
class BUSBAR_API OpenGate {
public:
    OpenGate() = default;
    OpenGate(const OpenGate&) = delete;
    OpenGate& operator=(const OpenGate&) = delete;
    virtual ~OpenGate() = default;

    /// The answer to a request.
    struct Admission {
        /// If false, the peer is told Bad_TcpServerTooBusy (Part 6, 7.1.5), and the channel ends.
        bool is_admitted{true};
        /// The time that the request, and everything after it, waits in the channel's input.
        Duration wait{Duration::zero()};
        /// Not admitted, and already reported to the log.
        bool is_known{false};
    };
    /// Decides about a request for a new channel or, with `is_renewal`, for a new token of an open
    /// one. It must not admit a request that would wait for longer than `longest`.
    [[nodiscard]] virtual Admission admit(bool is_renewal, Duration longest, TimePoint now) = 0;
    /// An admitted request was refused, or the channel has ended without a message that proves that
    /// the peer has its keys: a recorded request that is sent again opens a channel, too.
    virtual void failed(TimePoint now) = 0;
    /// The first such message arrived on a new channel.
    virtual void worked() = 0;
};

} // namespace busbar::channel
