#include "session_services.hpp"

#include <busbar/core/text.hpp>

namespace busbar::server::detail {

namespace {

/// The client gets Bad_SessionIdInvalid for its next request; its Subscriptions wait for another
/// session of it.
void displace(const SessionNeeds& needs, Session& session, const std::string& taker)
{
    Share& loser = *session.share;
    if (!std::exchange(loser.is_told, true)) { // logged once, since a flood displaces many
        needs.log.write(LogLevel::Warning, "session",
                        "\"" + printable(session.name) + "\" of " + loser.text +
                            (session.is_activated ? ", without a channel" : ", never activated") +
                            ", gives way to a session " + taker + ": " + loser.text + " had " +
                            std::to_string(loser.places) + " of " +
                            std::to_string(needs.sessions.size()) +
                            ". Others of his may follow without a word");
    }
    needs.keeper.close_session(session, status::Bad_SessionClosed, false);
}

} // namespace

bool make_session_place(const SessionNeeds& needs, std::string_view address)
{
    if (needs.sessions.size() < needs.limits().max_sessions) {
        return true;
    }
    // The future user is not known yet.
    const Share* const taker = needs.sessions.shares().find(UserIdentity{}, address);
    Session* const found = needs.sessions.find_giving_way(taker);
    if (found == nullptr) {
        return false;
    }
    displace(needs, *found, "from " + std::string{address});
    return true;
}

bool make_share(const SessionNeeds& needs, const Session& session, const UserIdentity& user,
                std::string_view address)
{
    const Share* const share = needs.sessions.shares().find(user, address);
    if (share == nullptr || share->items < needs.limits().max_sessions_per_user ||
        (session.share == share && session.is_shared_activated)) {
        return true;
    }
    Session* const found = needs.sessions.find_left(*share);
    if (found == nullptr) {
        return false;
    }
    displace(needs, *found, "of the same user from " + std::string{address});
    return true;
}

} // namespace busbar::server::detail
