#include "session_table.hpp"

#include "link.hpp"

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

void SessionTable::remove(Session& session)
{
    if (session.link != nullptr) {
        session.link->unbind(session);
    }
    const auto found = sessions_.find(session.authentication_token);
    if (found != sessions_.end()) {
        sessions_.erase(found);
    }
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

void SessionTable::unbind(Link& link)
{
    while (!link.sessions().empty()) {
        Session& session = *link.sessions().back();
        if (session.is_activated) {
            link.unbind(session);
        } else { // it can only be activated over the channel that has gone
            remove(session);
        }
    }
}

} // namespace busbar::server::detail
