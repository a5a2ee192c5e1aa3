#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <unordered_map>
#include <utility>

#include "recent_nonces.hpp"
#include "session.hpp"

namespace busbar::server::detail {

/// All sessions of a server by their authentication tokens. A Session stays where it is until it is
/// removed.
class SessionTable {
public:
    [[nodiscard]] Session* find(const NodeId& authentication_token);
    /// Takes a session whose token is not there yet.
    Session& add(std::unique_ptr<Session> session);
    void remove(Session& session);

    [[nodiscard]] std::size_t size() const { return sessions_.size(); }
    /// The oldest that was never activated, or null (Part 4, 5.7.2.1).
    [[nodiscard]] Session* oldest_unactivated();
    /// The session with the first deadline, or null if there is none at all.
    [[nodiscard]] Session* next_due();
    /// To be called when a session's deadline has come nearer; that it goes away, as it does with
    /// each request, is seen when the old one comes.
    void hurry(Session& session);
    [[nodiscard]] Session* any() const
    {
        return empty() ? nullptr : sessions_.begin()->second.get();
    }
    [[nodiscard]] bool empty() const { return sessions_.empty(); }
    [[nodiscard]] const std::unordered_map<NodeId, std::unique_ptr<Session>>& all() const
    {
        return sessions_;
    }
    /// A connection has gone; its activated sessions wait for another.
    void unbind(Peer& peer);
    /// Of sessions over channels with security.
    RecentNonces nonces;

private:
    void file(Session& session);

    std::unordered_map<NodeId, std::unique_ptr<Session>> sessions_;
    /// By a time that is not after their deadlines.
    std::set<std::pair<TimePoint, Session*>> due_;
};

} // namespace busbar::server::detail
