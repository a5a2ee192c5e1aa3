#include "session_services.hpp"

#include <algorithm>
#include <array>
#include <string>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>

#include "peer.hpp"
#include "server/users/shares.hpp"
#include "session_needs.hpp"
#include "session_record.hpp"

namespace busbar::server::detail {

namespace {

TimePoint deadline_of(const UserIdentity& user, DateTime today, TimePoint now)
{
    if (user.valid_until.is_null()) {
        return no_deadline;
    }
    // More than a session can last, and little enough to be counted in nanoseconds.
    constexpr std::int64_t most = std::int64_t{10} * 365 * 86'400 * DateTime::ticks_per_second;
    using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, DateTime::ticks_per_second>>;
    return now + Ticks{std::clamp(user.valid_until.ticks - today.ticks, std::int64_t{0}, most)};
}

} // namespace

UserIdentity with_roles(const SessionNeeds& needs, const Session& session, UserIdentity user)
{
    if (user.must_change_password) { // Part 18, 5.2.8
        user.roles.clear();
        user.access_level_mask = 0;
        return user;
    }
    if (needs.environment.roles == nullptr) {
        return user;
    }
    const bool is_secure = !session.security.policy->is_none();
    const RoleQuestion question{.user = user,
                                .application_uri = session.client_application_uri,
                                .is_trusted = is_secure,
                                .endpoint_url = session.endpoint_url.view(),
                                .security_mode = session.security.mode,
                                .security_policy_uri = session.security.policy->uri,
                                .listener = session.listener};
    const RoleMapper& mapper = *needs.environment.roles;
    UserRights given{0, {}};
    static_cast<void>(needs.guards.report().guard("RoleMapper::roles_of",
                                                  [&] { given = mapper.roles_of(question); }));
    UserRights all{static_cast<std::uint8_t>(user.access_level_mask | given.access_level_mask),
                   user.roles};
    for (std::string& role : given.roles) {
        if (std::find(all.roles.begin(), all.roles.end(), role) == all.roles.end()) {
            all.roles.push_back(std::move(role));
        }
    }
    UserRights left{0, {}};
    static_cast<void>(needs.guards.report().guard(
        "RoleMapper::limited", [&] { left = mapper.limited(question, std::move(all)); }));
    user.access_level_mask = left.access_level_mask;
    user.roles = std::move(left.roles);
    return user;
}

void set_user(const SessionNeeds& needs, const EndpointConfig& endpoint, Session& session,
              UserIdentity user, TimePoint now)
{
    const TimePoint end = deadline_of(user, needs.wall_time(), now);
    UserIdentity before = session.user;
    UserIdentity granted = session.granted;
    busbar::detail::Undo undo{[&] {
        session.user = std::move(before);
        session.granted = std::move(granted);
    }};
    session.granted = user;
    session.listener = session.peer != nullptr ? session.peer->listener() : 0;
    if (session.peer != nullptr) {
        session.address = session.peer->address();
    }
    session.change_user(with_roles(needs, session, std::move(user)));
    needs.sessions.update_share(session);
    undo.keep();
    session.is_user_untold = session.is_user_untold || !(session.user == before);
    session.user_deadline = endpoint.allows_anonymous ? end : no_deadline;
    session.ends_at = endpoint.allows_anonymous ? no_deadline : end;
    session.touch(now);
    needs.sessions.hurry(session);
}

void tell_activated(const SessionNeeds& needs, const Session& session, bool is_first,
                    const RequestMark& mark, const ExtensionObject& token)
{
    const std::array fields{
        RecordField{"UserTokenType", Variant{static_cast<std::int32_t>(session.user.token_type)}},
        RecordField{"IsFirst", Variant{is_first}},
        RecordField{"UserIdentityToken", Variant{token}}};
    Record record{RecordKind::SessionActivated, LogLevel::Info, "session"};
    record.text = "\"" + printable(session.name) + "\" activated by " + describe(session.user);
    record.actor = actor_of(session, mark);
    record.certificate = certificate_of(session);
    record.fields = fields;
    tell(needs.log, record);
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
    session.granted = users != nullptr ? users->anonymous() : anonymous_reader();
    session.change_user(with_roles(needs, session, session.granted));
    needs.sessions.update_share(session);
    needs.keeper.user_changed(session, now);
    session.is_user_untold = false;
    session.user_deadline = no_deadline; // last, so that a failure above is repeated
}

} // namespace busbar::server::detail
