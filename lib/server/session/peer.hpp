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

/// The part of a request's header that records refer to (Part 4, 7.33).
struct RequestMark {
    std::string audit_entry_id{};
    DateTime timestamp{};
};

/// The client's end of a connection, as services see it.
class Peer : public Outbox {
public:
    [[nodiscard]] virtual const channel::ServerChannel& channel() const = 0;
    /// The address without port.
    [[nodiscard]] virtual std::string_view address() const = 0;
    /// See Connection::came_by.
    [[nodiscard]] virtual std::uint32_t listener() const = 0;
    /// The sessions that use this channel.
    [[nodiscard]] virtual const std::vector<Session*>& sessions() const = 0;
    /// The session uses this channel from now on and no other. Call it again when it is activated,
    /// since it affects what the peer may send.
    virtual void bind(Session& session) = 0;
    /// The session does not use this channel any more.
    virtual void unbind(Session& session) = 0;
    /// Answers the session's pending requests here with `status`.
    virtual void end_operations(const Session& session, StatusCode status) = 0;
    /// The work that may still be done for this peer before others have their turn.
    [[nodiscard]] virtual Turn& turn() = 0;
    /// True if a callback of the user has thrown during the present request, which is then answered
    /// with Bad_InternalError, whatever result follows from the callback's missing answer.
    [[nodiscard]] virtual bool has_thrown() const { return false; }
    /// The log for messages about this peer.
    [[nodiscard]] virtual LogSink& log() = 0;

protected:
    ~Peer() = default;
};

} // namespace busbar::server::detail
