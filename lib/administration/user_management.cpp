#include "user_management.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <busbar/administration/user_management_nodes/nodes.hpp>
#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/enumerations.hpp>
#include <busbar/types/ids.hpp>

#include "giving_way.hpp"
#include "method_arguments.hpp"
#include "method_record.hpp"

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

/// Number of changes that may wait for the running one.
constexpr std::size_t max_waiting = 256;
constexpr std::ptrdiff_t max_waiting_of_user = 64;
constexpr const char* too_many_changes =
    "too many changes of users wait for the one that is under way; try again";

constexpr std::uint32_t bit(PasswordOptionsMask option)
{
    return static_cast<std::uint32_t>(option);
}

/// Part 18, 5.2.2.
std::uint32_t options_of(const server::PasswordRules& rules)
{
    using Option = PasswordOptionsMask;
    std::uint32_t bits =
        bit(Option::SupportInitialPasswordChange) | bit(Option::SupportDisableUser) |
        bit(Option::SupportDisableDeleteForUser) | bit(Option::SupportNoChangeForUser) |
        bit(Option::SupportDescriptionForUser);
    if (rules.needs_letters_and_digit) {
        bits |= bit(Option::RequiresUpperCaseCharacters) |
                bit(Option::RequiresLowerCaseCharacters) | bit(Option::RequiresDigitCharacters);
    }
    return bits;
}

/// Describes rules that the options cannot express, and those of names, which no other node shows.
LocalizedText restrictions_of(const server::PasswordRules& rules)
{
    std::string text = "A user's name has " + std::to_string(rules.min_name_length) + " to " +
                       std::to_string(rules.max_name_length) + " characters";
    if (!rules.name_characters.empty()) {
        text += ", only these: " + rules.name_characters;
    }
    for (const std::string& name : rules.reserved_names) {
        text += (&name == rules.reserved_names.data() ? ", and is none of: " : ", ") + name;
    }
    text += ". A password is not the user's name";
    if (!rules.password_characters.empty()) {
        text += "; only these characters: " + rules.password_characters;
    }
    return LocalizedText{String{"en"}, String{text}};
}

Variant users_of(const UserList& list)
{
    std::vector<UserManagementDataType> all;
    for (const User& user : list.all_users()) {
        UserManagementDataType& facts = all.emplace_back();
        facts.user_name = user.name;
        facts.user_configuration = UserConfigurationMask{user.configuration};
        facts.description = user.description;
    }
    return structures<UserManagementDataType>(all);
}

} // namespace

Configured<void> UserManagement::attach()
{
    if (const auto added = space_.add(user_management_nodes::nodes()); !added) {
        return misconfigured("users", "the nodes of UserManagement cannot be added", added.error());
    }
    bind_values();
    const auto bind = [&](std::uint32_t method, void (UserManagement::*function)(MethodCall)) {
        table_.bind_method(space_, space_.find(method), [this, function](MethodCall call) {
            (this->*function)(std::move(call));
        });
    };
    bind(id::UserManagement_AddUser, &UserManagement::add);
    bind(id::UserManagement_ModifyUser, &UserManagement::modify);
    bind(id::UserManagement_RemoveUser, &UserManagement::remove);
    bind(id::UserManagement_ChangePassword, &UserManagement::change_password);
    return {};
}

void UserManagement::bind_values()
{
    table_.bind_value(space_, space_.find(id::UserManagement_Users),
                      [this] { return users_of(users_); });
    table_.bind_value(space_, space_.find(id::UserManagement_PasswordLength), [this] {
        const server::PasswordRules& rules = users_.rules();
        const Range range{static_cast<double>(rules.min_password_length),
                          static_cast<double>(rules.max_password_length)};
        return Variant{ExtensionObject::from(range)};
    });
    table_.bind_value(space_, space_.find(id::UserManagement_PasswordOptions),
                      [this] { return Variant{options_of(users_.rules())}; });
    table_.bind_value(space_, space_.find(id::UserManagement_PasswordRestrictions),
                      [this] { return Variant{restrictions_of(users_.rules())}; });
}

/// Part 18, 5.2.5. The rules of the RoleSet give roles.
void UserManagement::add(MethodCall call)
{
    run(std::move(call), [this](const MethodCall& c) {
        User user;
        user.name = text_input(c, 0);
        user.configuration = c.input<std::uint32_t>(2);
        user.description = text_input(c, 3);
        return users_.prepare_add(std::move(user), text_view(c, 1), random_);
    });
}

/// Part 18, 5.2.6.
void UserManagement::modify(MethodCall call)
{
    const std::string name = text_input(call, 0);
    const bool has_configuration = call.input<bool>(3);
    const std::uint32_t configuration = call.input<std::uint32_t>(4);
    const bool is_disabled = has_configuration && (configuration & user_bit::disabled) != 0;
    if (is_disabled && call.user().token_type == UserTokenType::UserName &&
        call.user().name == name) {
        return call.fail(status::Bad_InvalidSelfReference,
                         "users cannot disable themselves; another administrator can");
    }
    run(
        std::move(call),
        [this](const MethodCall& c) {
            UserChange change;
            if (c.input<bool>(1)) {
                change.password = text_view(c, 2);
            }
            if (c.input<bool>(3)) {
                change.configuration = c.input<std::uint32_t>(4);
            }
            if (c.input<bool>(5)) {
                change.description = text_view(c, 6);
            }
            return users_.prepare_modify(text_view(c, 0), change, random_);
        },
        is_disabled ? name : std::string{});
}

/// Part 18, 5.2.7.
void UserManagement::remove(MethodCall call)
{
    const std::string name = text_input(call, 0);
    if (call.user().token_type == UserTokenType::UserName && call.user().name == name) {
        return call.fail(status::Bad_InvalidSelfReference,
                         "users cannot remove themselves; another administrator can");
    }
    run(
        std::move(call),
        [this, name](const MethodCall& /*call*/) {
            return UserList::Prepared{[this, name] { return users_.remove(name); }};
        },
        name);
}

/// Part 18, 5.2.8: every user with a password may call it, over an encrypted channel.
void UserManagement::change_password(MethodCall call)
{
    if (call.user().token_type != UserTokenType::UserName) {
        return call.fail(status::Bad_InvalidState,
                         "this session's user logged in without a password");
    }
    run(
        std::move(call),
        [this](const MethodCall& c) {
            return users_.prepare_change_password(c.user().name, text_view(c, 0), text_view(c, 1),
                                                  random_);
        },
        {}, true);
}

bool UserManagement::make_room(const Holder& holder)
{
    const auto waiting = std::count_if(jobs_.begin(), jobs_.end(), [&](const auto& job) {
        return job->holder.share == holder.share;
    });
    if (waiting >= max_waiting_of_user) {
        return false;
    }
    if (jobs_.size() < max_waiting) {
        return true;
    }
    const auto loser = find_giving_way(jobs_, holder, [](const auto&) { return 0; });
    if (loser == jobs_.end()) {
        return false;
    }
    const std::shared_ptr<Job> job = std::move(*loser);
    jobs_.erase(loser);
    job->call.fail(status::Bad_TooManyOperations, too_many_changes);
    return true;
}

void UserManagement::run(MethodCall call, Change change, const std::string& sessions_end_of,
                         bool tries_password)
{
    const Holder holder = holder_of(server_, call);
    if (!make_room(holder)) {
        return call.fail(status::Bad_TooManyOperations, too_many_changes);
    }
    const std::string& user = call.user().name;
    const auto job = std::make_shared<Job>(
        Job{std::move(call), holder, std::move(change), user, tries_password});
    if (!sessions_end_of.empty()) {
        job->end_sessions = std::make_unique<NodeTable::Task>();
        job->end_sessions->function = [this, whose = sessions_end_of] {
            server::RunningServer{server_}.end_sessions([&](const server::UserIdentity& each) {
                return each.token_type == UserTokenType::UserName && each.name == whose;
            });
        };
    }
    jobs_.push_back(job);
    start_next();
}

/// Takes the oldest job of another user than the last one, if there is one.
std::shared_ptr<UserManagement::Job> UserManagement::take_next()
{
    auto next = std::find_if(jobs_.begin(), jobs_.end(),
                             [&](const auto& job) { return job->user != last_user_; });
    next = next == jobs_.end() ? jobs_.begin() : next;
    std::shared_ptr<Job> job = std::move(*next);
    jobs_.erase(next);
    std::swap(last_user_, job->user);
    return job;
}

void UserManagement::start_next()
{
    while (busy_.expired() && !jobs_.empty()) {
        const std::shared_ptr<Job> job = take_next();
        const StatusCode thrown =
            busbar::detail::guarded(log_, "a change of users", [&] { start(job); });
        if (thrown.is_bad()) {
            job->call.fail(thrown);
        }
    }
}

void UserManagement::start(const std::shared_ptr<Job>& job)
{
    if (!may_start(*job)) {
        return;
    }
    const auto busy = std::make_shared<char>();
    const auto prepared = std::make_shared<Checked<UserList::Prepared>>();
    busy_ = busy;
    table_.run(
        worker_,
        [job, prepared] {
            if (!job->call.is_abandoned()) {
                *prepared = job->change(job->call);
            }
        },
        [this, job, prepared, busy](StatusCode worked) {
            const StatusCode status =
                worked.is_bad() ? worked : busbar::detail::guarded(log_, "a change of users", [&] {
                    finish(*job, *prepared);
                });
            if (status.is_bad()) {
                job->call.fail(status);
            }
            busy_.reset();
            start_next();
        });
}

bool UserManagement::may_start(Job& job)
{
    if (const StatusCode refused = check_wanted(job); refused.is_bad()) {
        job.call.fail(refused);
        return false;
    }
    if (const auto refusal = refusal_of(may_change_)) {
        tell_method(log_, RecordKind::UsersChanged, job.call, refusal->status, &*refusal);
        answer_with(job.call, *refusal);
        return false;
    }
    if (job.tries_password) {
        job.trial = server::RunningServer{server_}.begin_password_trial(job.holder.session);
    }
    if (job.tries_password && !job.trial) {
        const Refusal refusal{status::Bad_UserAccessDenied, "login lock-out",
                              "user \"" + printable(last_user_) + "\" has failed too often",
                              "Part 4, 5.7.3.1", "Wait, or restart the server"};
        tell_method(log_, RecordKind::UsersChanged, job.call, refusal.status, &refusal);
        answer_with(job.call, refusal);
        return false;
    }
    return true;
}

StatusCode UserManagement::check_wanted(const Job& job) const
{
    return job.call.is_abandoned()
               ? StatusCode{status::Bad_Timeout}
               : check_still(server_, job.holder, job.call.object_id(), job.call.method_id());
}

void UserManagement::finish(Job& job, const Checked<UserList::Prepared>& prepared)
{
    MethodCall& call = job.call;
    const server::RunningServer running{server_};
    const bool is_wrong =
        job.trial && !prepared && prepared.error().status == status::Bad_IdentityTokenInvalid;
    if (is_wrong) { // also if the client has not waited for that
        running.password_tried(*job.trial, false);
    }
    if (const StatusCode refused = check_wanted(job); refused.is_bad()) {
        return call.fail(refused);
    }
    const Checked<void> done = prepared ? (*prepared)() : refuse(prepared.error());
    if (!done) {
        tell_method(log_, RecordKind::UsersChanged, call, done.error().status, &done.error());
        return answer_with(call, done.error());
    }
    if (job.trial) {
        busbar::detail::attempt([&] { running.password_tried(*job.trial, true); });
    }
    tell_method(log_, RecordKind::UsersChanged, call, status::Good, nullptr);
    call.succeed();
    table_.raise(changed_);
    if (job.end_sessions != nullptr) {
        table_.post(std::move(job.end_sessions));
    }
}

} // namespace busbar::administration::detail
