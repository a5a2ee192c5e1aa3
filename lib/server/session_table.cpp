#include "session_table.hpp"

#include <algorithm>

namespace busbar::server::detail {

Session* SessionTable::find(const NodeId& authentication_token)
{
    const auto found = sessions_.find(authentication_token);
    return found == sessions_.end() ? nullptr : found->second.get();
}

Session& SessionTable::add(std::unique_ptr<Session> session)
{
    NodeId token = session->authentication_token;
    return *sessions_.emplace(std::move(token), std::move(session)).first->second;
}

void SessionTable::remove(const Session& session)
{
    const auto found = sessions_.find(session.authentication_token);
    if (found != sessions_.end()) {
        sessions_.erase(found);
    }
}

std::size_t SessionTable::count_of(const Link& link) const
{
    return static_cast<std::size_t>(
        std::count_if(sessions_.begin(), sessions_.end(),
                      [&](const auto& entry) { return entry.second->link == &link; }));
}

bool SessionTable::has_activated(const Link& link) const
{
    return std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& entry) {
        return entry.second->link == &link && entry.second->is_activated;
    });
}

Session* SessionTable::oldest_unactivated()
{
    Session* oldest = nullptr;
    for (const auto& [token, session] : sessions_) {
        if (!session->is_activated && (oldest == nullptr || session->created < oldest->created)) {
            oldest = session.get();
        }
    }
    return oldest;
}

Session* SessionTable::next_due() const
{
    Session* first = nullptr;
    for (const auto& [token, session] : sessions_) {
        if (first == nullptr || session->next_deadline() < first->next_deadline()) {
            first = session.get();
        }
    }
    return first;
}

void SessionTable::unbind(const Link& link)
{
    // What was never activated can only be activated over the channel that has gone.
    std::erase_if(sessions_, [&](const auto& entry) {
        return entry.second->link == &link && !entry.second->is_activated;
    });
    for (const auto& [token, session] : sessions_) {
        if (session->link == &link) {
            session->link = nullptr;
        }
    }
}

} // namespace busbar::server::detail
