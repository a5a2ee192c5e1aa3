#include "passwords.hpp"

#include <memory>
#include <string_view>
#include <utility>

#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>
#include <busbar/types/method.hpp>

#include "own_server.hpp"

namespace busbar::bench {

namespace {

constexpr std::chrono::milliseconds attack_patience{30'000};
/// Methods of one Call.
constexpr std::size_t in_one_call = 10;
constexpr std::string_view other_password = "Other-Password-2";

std::string name_of(std::size_t attacker)
{
    return "attacker" + std::to_string(attacker);
}

CallMethodRequest add_user(const std::string& name)
{
    CallMethodRequest call;
    call.object_id = NodeId{0, id::UserManagement};
    call.method_id = NodeId{0, id::UserManagement_AddUser};
    call.input_arguments = {Variant{String{name}}, Variant{String{good_password}},
                            Variant{std::uint32_t{0}}, Variant{String{}}};
    return call;
}

CallMethodRequest remove_user(const std::string& name)
{
    CallMethodRequest call;
    call.object_id = NodeId{0, id::UserManagement};
    call.method_id = NodeId{0, id::UserManagement_RemoveUser};
    call.input_arguments = {Variant{String{name}}};
    return call;
}

CallMethodRequest change_password(std::string_view before, std::string_view after)
{
    CallMethodRequest call;
    call.object_id = NodeId{0, id::UserManagement};
    call.method_id = NodeId{0, id::UserManagement_ChangePassword};
    call.input_arguments = {Variant{String{before}}, Variant{String{after}}};
    return call;
}

CallMethodRequest make_administrator(const std::string& name)
{
    CallMethodRequest call;
    call.object_id = NodeId{0, id::WellKnownRole_SecurityAdmin};
    call.method_id = NodeId{0, id::RoleType_AddIdentity};
    call.input_arguments = {Variant{ExtensionObject::from(
        IdentityMappingRuleType{IdentityCriteriaType::UserName, String{name}})}};
    return call;
}

std::unique_ptr<net::ClientLoop> log_in(Load& load)
{
    auto loop = std::make_unique<net::ClientLoop>();
    return load.open(*loop, true, attack_patience) ? std::move(loop) : nullptr;
}

/// Calls all of them, and counts how they ended. False if there was no answer.
bool call(net::ClientLoop& loop, std::vector<CallMethodRequest> methods, Tally& tally)
{
    CallRequest request;
    for (CallMethodRequest& each : methods) {
        request.methods_to_call.push_back(std::move(each));
    }
    const auto event = loop.call(request);
    const auto response = event ? event->response<CallResponse>() : fail(event.error());
    if (!response) {
        ++tally.refused;
        return false;
    }
    for (const CallMethodResult& result : response->results) {
        ++(result.status_code.is_bad() ? tally.refused : tally.answered);
    }
    return true;
}

/// Users that come and go, a password that changes, and one that is guessed at.
std::vector<std::vector<CallMethodRequest>> calls_of(std::size_t attacker)
{
    std::vector<CallMethodRequest> adds;
    std::vector<CallMethodRequest> changes;
    std::vector<CallMethodRequest> removes;
    for (std::size_t i = 0; i < in_one_call; ++i) {
        const std::string name = name_of(attacker) + "-" + std::to_string(i);
        adds.push_back(add_user(name));
        removes.push_back(remove_user(name));
    }
    changes.push_back(change_password(good_password, other_password));
    changes.push_back(change_password(other_password, good_password));
    changes.push_back(change_password("Wrong-Password-1", other_password));
    return {std::move(adds), std::move(changes), std::move(removes)};
}

} // namespace

Result<PasswordAttackers> PasswordAttackers::add(const Options& options, std::size_t count)
{
    Load load{options};
    const auto prepared = load.prepare();
    const auto loop = prepared ? log_in(load) : nullptr;
    if (!loop) {
        return fail(prepared ? StatusCode{status::Bad_UserAccessDenied} : prepared.error());
    }
    for (std::size_t i = 0; i < count; ++i) {
        Tally tally;
        if (!call(*loop, {add_user(name_of(i)), make_administrator(name_of(i))}, tally) ||
            tally.refused != 0) {
            return fail(status::Bad_ResourceUnavailable);
        }
    }
    loop->close();
    return PasswordAttackers{options};
}

Attack PasswordAttackers::attack(std::size_t attackers) const
{
    const auto what = [this](Tally& tally, std::size_t attacker) {
        Options his = options_;
        his.user = name_of(attacker);
        his.password = good_password;
        Load load{his};
        his.password = "Wrong-Password-1";
        Load guesses{his};
        if (!load.prepare() || !guesses.prepare()) {
            ++tally.refused;
            return;
        }
        const auto calls = calls_of(attacker);
        auto loop = log_in(load);
        for (std::size_t i = attacker; !tally.is_over; ++i) {
            if (i % (calls.size() + 1) == calls.size()) {
                ++(log_in(guesses) ? tally.answered : tally.refused);
            } else if (!loop || !call(*loop, calls[i % (calls.size() + 1)], tally)) {
                loop = log_in(load);
            }
        }
    };
    return {std::to_string(attackers) + " change passwords, add users and guess", attackers, what};
}

} // namespace busbar::bench
