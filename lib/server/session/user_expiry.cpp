#include "user_expiry.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

#include "session_needs.hpp"

#include "session_record.hpp"
namespace busbar::server::detail {

namespace {

TimePoint deadline_of(const UserIdentity& user, DateTime today, TimePoint now)
{
    if (user.valid_until.is_null()) {
        return no_deadline;
    }
    // Farther away than a session can last, and near enough to be counted in nanoseconds.
    constexpr std::int64_t most = std::int64_t{10} * 365 * 86'400 * DateTime::ticks_per_second;
    using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
    return now + Ticks{std::clamp(user.valid_until.ticks - today.ticks, std::int64_t{0}, most)};
}

std::string describe(const UserIdentity& user)
{
    switch (user.token_type) {
    case UserTokenType::UserName:
        return "user \"" + printable(user.name) + "\"";
    case UserTokenType::Certificate:
        return "the user of certificate \"" + printable(user.name) + "\"";
    case UserTokenType::IssuedToken:
        return "user \"" + printable(user.name) + "\" of \"" + printable(user.issuer) + "\"";
    case UserTokenType::Anonymous:
        break;
    }
    return "an anonymous user";
}

} // namespace

void set_user(const SessionNeeds& needs, const EndpointConfig& endpoint, Session& session,
              UserIdentity user, TimePoint now)
{
    needs.log.write(LogLevel::Info, "session",
                    "\"" + printable(session.name) + "\" activated by " + describe(user));
    const TimePoint end = deadline_of(user, needs.wall_time(), now);
    session.change_user(std::move(user));
    session.user_deadline = endpoint.allows_anonymous ? end : no_deadline;
    session.ends_at = endpoint.allows_anonymous ? no_deadline : end;
    session.touch(now);
    needs.sessions.hurry(session);
}

void expire_user(const SessionNeeds& needs, Session& session, TimePoint now)
{
    if (now < session.user_deadline) {
        return;
    }
    needs.log.write(LogLevel::Info, "session",
                    "\"" + printable(session.name) + "\" is anonymous now: the token of " +
                        describe(session.user) + " has expired");
    UserStore* users = needs.environment.users;
    session.change_user(users != nullptr ? users->anonymous() : anonymous_reader());
    session.user_deadline = no_deadline;
    needs.keeper.user_changed(session, now);
}

} // namespace busbar::server::detail
void tell_activated(const SessionNeeds& needs, const Session& session,
                    std::string_view audit_entry_id)
{
    const std::array fields{
        RecordField{"UserTokenType", Variant{static_cast<std::int32_t>(session.user.token_type)}}};
    Record record{RecordKind::SessionActivated, LogLevel::Info, "session"};
    record.text = "\"" + printable(session.name) + "\" activated by " + describe(session.user);
    record.actor = actor_of(session, audit_entry_id);
    record.certificate = certificate_of(session);
    record.fields = fields;
    tell(needs.log, record);
}

