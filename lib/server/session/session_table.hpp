#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "server/users/shares.hpp"
#include "session.hpp"

namespace busbar::server::detail {

/// The client nonces of the last sessions, as hashes: one must not be used again (Part 4,
/// 5.7.2.2).
class RecentNonces {
public:
    /// Returns false if the nonce is among them; otherwise adds it in place of the oldest.
    [[nodiscard]] bool take(std::span<const std::byte> nonce)
    {
        const std::size_t hash = std::hash<std::string_view>{}(
            {reinterpret_cast<const char*>(nonce.data()), nonce.size()});
        const auto end = hashes_.begin() + static_cast<std::ptrdiff_t>(count_);
        if (std::find(hashes_.begin(), end, hash) != end) {
            return false;
        }
        hashes_[next_] = hash;
        next_ = (next_ + 1) % hashes_.size();
        count_ = std::max(count_, next_ == 0 ? hashes_.size() : next_);
        return true;
    }

private:
    std::array<std::size_t, 128> hashes_{};
    std::size_t count_{0};
    std::size_t next_{0};
};

/// All sessions of a server by their authentication tokens. A Session keeps its address until it is
/// removed.
class SessionTable {
public:
    [[nodiscard]] Session* find(const NodeId& authentication_token);
    /// Adds a session with a new token.
    Session& add(std::unique_ptr<Session> session);
    void remove(Session& session);

    [[nodiscard]] std::size_t size() const { return sessions_.size(); }
    /// Returns the session that shall end for one more of `taker`, which may be null: the oldest
    /// that was never activated, of the user who has most (Part 4, 5.7.2.1); else the oldest
    /// without a channel, of the user who has most and more than the taker. Null if there is none.
    [[nodiscard]] Session* find_giving_way(const Share* taker) const;
    /// Returns the user's oldest activated session without a channel.
    [[nodiscard]] Session* find_left(const Share& share) const;
    [[nodiscard]] const Shares& shares() const { return shares_; }
    /// Call it when the session has another user or address, or was activated.
    void update_share(Session& session);
    /// Returns the session with the first deadline, or null if there is none.
    [[nodiscard]] Session* next_due();
    /// Call it when a session's deadline has become earlier; a later one, as after each request, is
    /// noticed when the old one comes.
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
    /// A connection was closed; its activated sessions wait for another one.
    void unbind(Peer& peer);
    /// Nonces of sessions over channels with security.
    RecentNonces nonces;

private:
    void file(Session& session);

    Shares shares_;
    std::unordered_map<NodeId, std::unique_ptr<Session>> sessions_;
    /// Sorted by a time that is not after their deadlines.
    std::set<std::pair<TimePoint, Session*>> due_;
};

} // namespace busbar::server::detail
