#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <unordered_map>
#include <utility>

#include "recent_nonces.hpp"
#include "server/users/shares.hpp"
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
    /// The session that is to end for one more of `taker`, who may have none: the oldest that was
    /// never activated, of the user who has most (Part 4, 5.7.2.1); else the oldest without a
    /// channel, of the user who has most and more than the taker. Null if there is none.
    [[nodiscard]] Session* find_giving_way(const Share* taker) const;
    /// The user's oldest that is activated and without a channel.
    [[nodiscard]] Session* find_left(const Share& share) const;
    [[nodiscard]] const Shares& shares() const { return shares_; }
    /// To be called when it has another user or address, or was activated.
    void update_share(Session& session);
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

    Shares shares_;
    std::unordered_map<NodeId, std::unique_ptr<Session>> sessions_;
    /// By a time that is not after their deadlines.
    std::set<std::pair<TimePoint, Session*>> due_;
};

} // namespace busbar::server::detail
