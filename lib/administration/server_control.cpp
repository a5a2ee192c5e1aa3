#include "server_control.hpp"

#include <chrono>
#include <memory>
#include <utility>

#include <busbar/administration/state_change_nodes/nodes.hpp>
#include <busbar/core/status_codes.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/ids.hpp>

#include "method_record.hpp"
#include "permissions.hpp"

namespace busbar::administration::detail {

namespace {

using server::MethodCall;

/// A day; a longer countdown is probably a mistake.
constexpr std::uint32_t max_seconds = 86'400;
constexpr std::size_t max_reason = 256;

/// The text for a request without a reason.
std::string_view usual_reason(ServerState state, bool restarts)
{
    if (restarts) {
        return "an administrator restarts the server";
    }
    switch (state) {
    case ServerState::Shutdown:
        return "an administrator stops the server";
    case ServerState::Running:
        return "an administrator lets the server continue";
    default:
        return "an administrator changed the state of the server";
    }
}

Unexpected<Refusal> refuse_state(StatusCode status, std::string found)
{
    return refuse({status, "state of the server", std::move(found), "Part 5, 9.4", {}});
}

} // namespace

Configured<void> ServerControl::attach()
{
    model::AddressSpace& space = needs_.server.address_space();
    if (const auto added = space.add(state_change_nodes::nodes()); !added) {
        return misconfigured("stop", "RequestServerStateChange cannot be added", added.error());
    }
    needs_.table.bind_method(space, space.find(id::Server_RequestServerStateChange),
                             [this](MethodCall call) { request(std::move(call)); });
    return {};
}

Checked<void> ServerControl::check(const Wish& wish) const
{
    const bool is_counting = server::RunningServer{needs_.server}.state() == ServerState::Shutdown;
    switch (wish.state) {
    case ServerState::Running:
    case ServerState::Shutdown:
        if (wish.restarts && !needs_.restart && !needs_.replace) {
            return refuse_state(status::Bad_InvalidState, "this server cannot restart itself");
        }
        break;
    case ServerState::Suspended:
    case ServerState::Failed:
        if (wish.restarts || is_counting) {
            return refuse_state(
                status::Bad_InvalidState,
                wish.restarts
                    ? "a restart can only be requested with the states Running and Shutdown"
                    : "the server is about to stop");
        }
        break;
    default:
        return refuse_state(status::Bad_InvalidState,
                            "expected Running, Shutdown, Suspended or Failed");
    }
    // The number of seconds does not matter for a server that stays.
    if (wish.ends_server() && wish.seconds_till_shutdown > max_seconds) {
        return refuse_state(status::Bad_OutOfRange,
                            "a stop in " + std::to_string(wish.seconds_till_shutdown) +
                                " seconds, expected at most " + std::to_string(max_seconds));
    }
    if (wish.reason.size() > max_reason) {
        return refuse_state(status::Bad_OutOfRange,
                            "a reason of " + std::to_string(wish.reason.size()) +
                                " bytes, expected at most " + std::to_string(max_reason));
    }
    return wish.state == ServerState::Running && !wish.restarts ? check_run() : Checked<void>{};
}

Checked<void> ServerControl::check_run() const
{
    const auto may = needs_.may_run ? needs_.may_run() : Configured<void>{};
    return may ? Checked<void>{} : refuse_state(may.error().status, text(may.error()));
}

void ServerControl::request(MethodCall call)
{
    Wish wish;
    wish.state = static_cast<ServerState>(call.input<std::int32_t>(0));
    if (wish.state < ServerState::Running || wish.state > ServerState::Unknown) {
        Array<StatusCode> results;
        results.resize(call.inputs().size());
        results[0] = status::Bad_OutOfRange;
        return call.refuse(std::move(results), "the state is not a value of ServerState");
    }
    wish.return_time = call.input<DateTime>(1);
    wish.seconds_till_shutdown = call.input<std::uint32_t>(2);
    wish.restarts = call.input<bool>(4);
    if (const auto* const text = call.inputs()[3].get_if<LocalizedText>()) {
        wish.reason = text->text.str();
    }
    if (const auto may = check(wish); !may) {
        return answer_with(call, may.error());
    }
    if (wish.reason.empty()) {
        wish.reason = usual_reason(wish.state, wish.restarts);
    }
    if (wish.restarts && needs_.replace && needs_.may_replace) {
        return agree_if_replaceable(std::move(call), std::move(wish));
    }
    agree(call, std::move(wish));
}

void ServerControl::agree_if_replaceable(MethodCall call, Wish wish)
{
    const Holder holder = holder_of(needs_.server, call);
    const auto may = std::make_shared<Configured<void>>();
    const auto kept = std::make_shared<MethodCall>(std::move(call));
    // What was found before may be otherwise after the work, and the client no longer wait.
    const auto end = [this, holder, may, kept, asked = std::move(wish)](StatusCode done) {
        if (done.is_good()) {
            done = kept->is_abandoned()
                       ? StatusCode{status::Bad_Timeout}
                       : check_still(needs_.server, holder, kept->object_id(), kept->method_id());
        }
        if (done.is_bad()) {
            return kept->fail(done);
        }
        if (!*may) {
            const std::string why = text(may->error());
            needs_.log.write(LogLevel::Error, "stop",
                             "a restart is refused: " + why + "; nothing was changed");
            return answer_with(*kept, refuse_state(may->error().status, why).error());
        }
        if (const auto still = check(asked); !still) {
            return answer_with(*kept, still.error());
        }
        agree(*kept, asked);
    };
    needs_.table.run(
        needs_.worker, [may, check = needs_.may_replace()] { *may = check(); }, end);
}

void ServerControl::agree(MethodCall& call, Wish wish)
{
    auto task = std::make_unique<NodeTable::Task>();
    task->function = [this, asked = std::move(wish)] { carry_out(asked); };
    task->rounds = 2; // after a second Method of the same Call has been answered, too
    tell_method(needs_.log, RecordKind::SettingsChanged, call, status::Good, nullptr);
    call.succeed();
    needs_.table.post(std::move(task));
}

void ServerControl::carry_out(const Wish& wish)
{
    const server::RunningServer running{needs_.server};
    if (!wish.ends_server()) {
        static_cast<void>(running.change_state(wish.state, wish.reason, wish.return_time));
    } else if (wish.restarts && needs_.replace) {
        needs_.replace(
            {wish.reason, std::chrono::seconds{wish.seconds_till_shutdown}, wish.return_time});
    } else if (running.begin_countdown(wish.reason,
                                       std::chrono::seconds{wish.seconds_till_shutdown},
                                       wish.return_time, *this)) {
        restarts_ = wish.restarts;
        reason_ = wish.reason;
    }
}

ServerState ServerControl::countdown_ended()
{
    if (!restarts_ && needs_.shut_down) {
        needs_.shut_down(reason_);
        return ServerState::Failed;
    }
    restarts_ ? needs_.restart() : needs_.stop();
    return ServerState::Shutdown;
}

} // namespace busbar::administration::detail
