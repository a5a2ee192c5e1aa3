#include "session_table.hpp"

#include "peer.hpp"

namespace busbar::server::detail {

Session* SessionTable::find(const NodeId& authentication_token)
{
    const auto found = sessions_.find(authentication_token);
    return found == sessions_.end() ? nullptr : found->second.get();
}

Session& SessionTable::add(std::unique_ptr<Session> session)
{
    NodeId token = session->authentication_token;
    session->filed_for = session->next_deadline();
    due_.emplace(session->filed_for, session.get());
    return *sessions_.emplace(std::move(token), std::move(session)).first->second;
}

void SessionTable::remove(Session& session)
{
    if (session.peer != nullptr) {
        session.peer->unbind(session);
    }
    due_.erase({session.filed_for, &session});
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

Session* SessionTable::next_due()
{
    while (!due_.empty() && due_.begin()->first < due_.begin()->second->next_deadline()) {
        file(*due_.begin()->second);
    }
    return due_.empty() ? nullptr : due_.begin()->second;
}

void SessionTable::hurry(Session& session)
{
    if (session.next_deadline() < session.filed_for) {
        file(session);
    }
}

void SessionTable::file(Session& session)
{
    auto entry = due_.extract({session.filed_for, &session});
    session.filed_for = session.next_deadline();
    entry.value() = {session.filed_for, &session};
    due_.insert(std::move(entry));
}

void SessionTable::unbind(Peer& peer)
{
    while (!peer.sessions().empty()) {
        Session& session = *peer.sessions().back();
        if (session.is_activated) {
            peer.unbind(session);
        } else { // it can only be activated over the channel that has gone
            remove(session);
        }
    }
}

} // namespace busbar::server::detail
