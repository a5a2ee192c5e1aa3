#include "session_requests.hpp"

namespace busbar::client::detail {

SessionRequests::SessionRequests(Requester& requester, std::function<void()> answered)
    : requester_{requester}, answered_{std::move(answered)}
{
}

SessionRequests::~SessionRequests()
{
    end_session();
}

void SessionRequests::begin_session()
{
    if (!has_session()) {
        session_ = std::make_shared<bool>(true);
    }
    has_work_ = true;
}

void SessionRequests::end_session()
{
    session_.reset();
    for (const auto& [token, request] : std::exchange(requests_, {})) {
        requester_.cancel(request);
    }
}

std::function<bool()> SessionRequests::in_session() const
{
    return [session = std::weak_ptr{session_}] { return !session.expired(); };
}

} // namespace busbar::client::detail
