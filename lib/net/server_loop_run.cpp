#include "server_loop_impl.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <asio/post.hpp>

#include <busbar/net/system.hpp>
#include <busbar/server/running_server.hpp>

namespace busbar::net {

namespace {

/// Returns the deadline, or the next full millisecond after it: intervals are in milliseconds, and
/// deadlines of many Subscriptions that differ by less are handled in one turn of the loop.
/// Intervals of whole milliseconds stay as long as they are.
TimePoint on_grid(TimePoint deadline)
{
    return deadline == no_deadline ? deadline
                                   : std::chrono::ceil<std::chrono::milliseconds>(deadline);
}

/// Pause between attempts to get memory for waiting.
constexpr std::chrono::milliseconds retry_pause{100};

/// Turns that run() takes after its time, each for one occurrence.
constexpr std::size_t max_late_turns = 64;

} // namespace

ServerLoop::Impl::Impl(LogSink& l) : log{l}, waker{context}
{
    detail::keep_free_memory(); // memory_return returns it
    events.on_activity = [this] {
        memory_return.note_activity(detail::now());
        after_activity();
    };
    events.on_opened = [this](std::uint64_t id) {
        for (const auto& dialer : dialers) {
            dialer->opened(id);
        }
    };
    events.on_ended = [this](std::uint64_t id) {
        for (const auto& dialer : dialers) {
            dialer->ended(id);
        }
    };
}

/// Returns the connection's id, unless it is refused or closed already.
std::optional<std::uint64_t>
ServerLoop::Impl::adopt(Socket socket, ServedServer::Direction direction, std::uint32_t listener)
{
    const std::uint64_t id = ++last_connection;
    const auto adopted = served.back()->adopt(socket, {direction, listener}, id);
    if (adopted) {
        return id;
    }
    if (direction == ServedServer::Direction::FromClient &&
        adopted.error() != status::Bad_CommunicationError) {
        turn_away(std::move(socket), adopted.error(), "no place for a connection");
    }
    return std::nullopt;
}

/// The activity of one connection may have created output for others.
void ServerLoop::Impl::after_activity()
{
    for_each([](ServedServer& each) { each.pump(); });
    retire();
    if (has_stopped()) {
        context.stop();
        return;
    }
    await_deadline();
}

/// Drops replaced servers without clients; none of their functions is running then.
void ServerLoop::Impl::retire()
{
    for (std::size_t i = 0; i + 1 < served.size();) {
        if (!served[i]->is_over()) {
            ++i;
            continue;
        }
        const auto released = std::move(served[i]->released);
        served.erase(served.begin() + static_cast<std::ptrdiff_t>(i));
        if (released) {
            busbar::detail::guarded(log, "Handover::released", released);
        }
    }
}

/// Called after an exception that may have prevented waits. False if it may still be so.
bool ServerLoop::Impl::resume()
{
    const StatusCode thrown = busbar::detail::guarded(log, "resuming", [this] {
        asio::post(context, [this] { after_activity(); });
        listeners.resume();
        await_wake();
        await_hangup();
        if (is_stopping && !is_told_to_stop) {
            tell_to_stop();
        }
    });
    return thrown.is_good();
}

/// Runs until everything has stopped, or `until`. Recovers from exceptions, now or when there is
/// memory.
void ServerLoop::Impl::run(TimePoint until)
{
    std::size_t late_turns = 0;
    while (!context.stopped()) {
        bool has_done = true;
        const StatusCode thrown =
            busbar::detail::guarded(log, "network handler", [&] { has_done = turn(until); });
        if (is_behind || thrown.is_bad()) {
            is_behind = !resume();
        }
        // What is ready is handled even without time, but a flood of it does not keep the caller.
        if (detail::now() >= until && (!has_done || ++late_turns == max_late_turns)) {
            return;
        }
    }
}

/// Handles what is due or else the next occurrence, of which there may be none for a while. Where
/// deadlines never end, they and the sockets have turns alternately. A turn of the sockets is one
/// occurrence, since these may never end either: a flood of connections is always ready. Returns
/// false if nothing occurred before `until`.
bool ServerLoop::Impl::turn(TimePoint until)
{
    const bool is_due = deadline <= detail::now();
    const bool has_had_turn = std::exchange(had_deadline, is_due && !had_deadline);
    if (is_due && has_had_turn) {
        return context.poll_one() != 0;
    }
    if (is_due) {
        handle_deadline();
        return true;
    }
    if (is_behind) {
        return context.run_until(std::min(until, detail::now() + retry_pause)) != 0;
    }
    if (until <= detail::now()) {
        return context.poll_one() != 0; // run_one_until() handles nothing then
    }
    return context.run_one_until(std::min(until, deadline)) != 0 || deadline <= until;
}

void ServerLoop::Impl::await_wake()
{
    waker.wait([this] {
        for_each([this](ServedServer& each) {
            busbar::detail::guarded(log, "Server::handle_completions",
                                    [&each] { each.server().handle_completions(detail::now()); });
        });
        after_activity();
    });
}

/// Clients of replaced servers were notified; they get no more time than those of this one.
bool ServerLoop::Impl::has_stopped() const
{
    return is_stopping && (served.empty() || served.back()->is_over()) &&
           std::ranges::all_of(registrations, [](const auto& one) { return one->is_stopped(); });
}

void ServerLoop::Impl::await_deadline()
{
    TimePoint first = memory_return.next_deadline();
    for_each([&](ServedServer& each) { first = std::min(first, each.server().next_deadline()); });
    deadline = on_grid(first);
}

void ServerLoop::Impl::handle_deadline()
{
    const TimePoint now = detail::now();
    deadline = no_deadline; // until after_activity(), which a failure has called again
    for_each([this, now](ServedServer& each) {
        if (each.server().next_deadline() <= now) {
            busbar::detail::guarded(log, "Server::handle_deadline",
                                    [&] { each.server().handle_deadline(now); });
        }
    });
    memory_return.look(now);
    after_activity();
}

void ServerLoop::Impl::serve(server::Server& server)
{
    served.push_back(std::make_unique<ServedServer>(server, context.get_executor(), events));
    server.start(detail::now());
}

void ServerLoop::Impl::begin_stop()
{
    if (!std::exchange(is_stopping, true)) {
        tell_to_stop();
    }
}

/// May throw, and is then called once more.
void ServerLoop::Impl::tell_to_stop()
{
    listeners.close();
    for (const auto& dialer : dialers) {
        dialer->stop();
    }
    for (const auto& registration : registrations) {
        registration->stop([this] { after_activity(); });
    }
    served.back()->server().begin_shutdown(detail::now(), "the server is being stopped");
    is_told_to_stop = true;
    after_activity();
}

void ServerLoop::Impl::await_hangup()
{
    if (awaits_hangup || !on_hangup) {
        return;
    }
    hangup->async_wait([this](std::error_code error, int) {
        awaits_hangup = false;
        if (!error) {
            busbar::detail::guarded(log, "on_hangup handler", [this] { on_hangup(); });
            await_hangup();
            after_activity();
        }
    });
    awaits_hangup = true;
}

} // namespace busbar::net
