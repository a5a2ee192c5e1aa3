#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/channel/server_channel.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/log.hpp>

#include "outbox.hpp"
#include "turn.hpp"

namespace busbar::server::detail {

class Session;

/// What records say of the request that they come from: what its header has (Part 4, 7.33).
struct RequestMark {
    std::string audit_entry_id{};
    DateTime timestamp{};
};

/// The client's end of a connection, as services see it.
class Peer : public Outbox {
public:
    [[nodiscard]] virtual const channel::ServerChannel& channel() const = 0;
    /// Without port.
    [[nodiscard]] virtual std::string_view address() const = 0;
    /// See Connection::came_by.
    [[nodiscard]] virtual std::uint32_t listener() const = 0;
    /// The sessions that use this channel.
    [[nodiscard]] virtual const std::vector<Session*>& sessions() const = 0;
    /// The session uses this channel from now on and no other. To be called again when it is
    /// activated: what the peer may send depends on it.
    virtual void bind(Session& session) = 0;
    /// It uses this channel no more.
    virtual void unbind(Session& session) = 0;
    /// Answers what the session has pending here with `status`.
    virtual void end_operations(const Session& session, StatusCode status) = 0;
    /// What may still be done for this peer before others have their turn.
    [[nodiscard]] virtual Turn& turn() = 0;
    /// A callback of the user's has thrown while the present request was served: it will be
    /// answered with Bad_InternalError, whatever is made of the callback's silence.
    [[nodiscard]] virtual bool has_thrown() const { return false; }
    /// For what is to be said of this peer.
    [[nodiscard]] virtual LogSink& log() = 0;

protected:
    ~Peer() = default;
};

} // namespace busbar::server::detail
