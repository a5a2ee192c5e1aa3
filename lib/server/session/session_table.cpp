#include "session_table.hpp"

#include <tuple>

#include <busbar/core/detail/guarded.hpp>

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
    session->is_shared_activated = session->is_activated;
    const std::size_t items = session->is_activated ? 1 : 0;
    Share& share = shares_.enter(session->user, session->address, items);
    busbar::detail::Undo left{[&] { shares_.leave(share, items); }};
    session->share = &share;
    const auto due = due_.emplace(session->filed_for, session.get()).first;
    busbar::detail::Undo unfiled{[&] { due_.erase(due); }};
    Session& added = *sessions_.emplace(std::move(token), std::move(session)).first->second;
    unfiled.keep();
    left.keep();
    return added;
}

void SessionTable::remove(Session& session)
{
    if (session.peer != nullptr) {
        session.peer->unbind(session);
    }
    due_.erase({session.filed_for, &session});
    shares_.leave(*session.share, session.is_shared_activated ? 1 : 0);
    const auto found = sessions_.find(session.authentication_token);
    if (found != sessions_.end()) {
        sessions_.erase(found);
    }
}

Session* SessionTable::find_giving_way(const Share* taker) const
{
    // The user with most sessions first, and of his sessions the oldest.
    const auto order = [](const Session& s) {
        return std::tuple{s.is_activated, ~s.share->places, s.created};
    };
    const std::size_t had = taker == nullptr ? 0 : taker->places;
    Session* first = nullptr;
    for (const auto& [token, session] : sessions_) {
        const bool is_left =
            session->peer == nullptr && (session->share == taker || session->share->places > had);
        if ((!session->is_activated || is_left) &&
            (first == nullptr || order(*session) < order(*first))) {
            first = session.get();
        }
    }
    return first;
}

Session* SessionTable::find_left(const Share& share) const
{
    Session* first = nullptr;
    for (const auto& [token, session] : sessions_) {
        if (session->share == &share && session->is_activated && session->peer == nullptr &&
            (first == nullptr || session->created < first->created)) {
            first = session.get();
        }
    }
    return first;
}

void SessionTable::update_share(Session& session)
{
    Share& next = shares_.enter(session.user, session.address, session.is_activated ? 1 : 0);
    shares_.leave(*std::exchange(session.share, &next), session.is_shared_activated ? 1 : 0);
    session.is_shared_activated = session.is_activated;
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
        } else { // it can only be activated over the channel that was closed
            remove(session);
        }
    }
}

} // namespace busbar::server::detail
