#pragma once

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>

namespace busbar::channel {

/// Decides when a server does the asymmetric work of an OpenSecureChannel, which takes it
/// milliseconds and who sends the message nothing (Part 2, 5.1.2.2). Asked before any of it is
/// done; never with policy None, which has none. On the thread of the channel.
class BUSBAR_API OpenGate {
public:
    OpenGate() = default;
    OpenGate(const OpenGate&) = delete;
    OpenGate& operator=(const OpenGate&) = delete;
    virtual ~OpenGate() = default;

    struct Admission {
        /// False: the peer is told Bad_TcpServerTooBusy (Part 6, 7.1.5), and the channel ends.
        bool is_admitted{true};
        /// How long the request, and all that comes after it, waits in the channel's input.
        Duration wait{Duration::zero()};
        /// Not admitted, and the log need not be told again.
        bool is_known{false};
    };
    /// A request for a new channel or, as `is_renewal`, for a new token of one that is open. What
    /// would have to wait for more than `longest` is not to be admitted.
    [[nodiscard]] virtual Admission admit(bool is_renewal, Duration longest, TimePoint now) = 0;
    /// What was admitted was refused, or the channel has ended without a message that shows that
    /// the peer has its keys: an overheard request that is sent again opens a channel, too.
    virtual void failed(TimePoint now) = 0;
    /// The first such message came over a new channel.
    virtual void worked() = 0;
};

} // namespace busbar::channel
