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
    cancel_all();
}

void SessionRequests::cancel_all()
{
    for (const auto& entry : std::exchange(requests_, {})) {
        busbar::detail::attempt([&] { requester_.cancel(entry.second); });
    }
}

void SessionRequests::watch(FunctionRef<void()> work)
{
    busbar::detail::Undo undo{[this] { has_failed_ = true; }};
    work();
    undo.keep();
}

std::function<bool()> SessionRequests::in_session() const
{
    return [session = std::weak_ptr{session_}] { return !session.expired(); };
}

} // namespace busbar::client::detail
