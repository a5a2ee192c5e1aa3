#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/server/running_server.hpp>
#include <busbar/types/ids.hpp>

#include "server_impl.hpp"

/// The state of a server (Part 5, 12.6) during its life.
namespace busbar::server {

namespace {

Event state_event(ServerState state, std::string_view reason)
{
    constexpr std::uint16_t severity = 900;
    constexpr std::uint16_t severity_of_return = 100;
    Event event;
    event.event_type = NodeId{0, id::SystemStatusChangeEventType};
    event.source_name = "Server";
    event.message = LocalizedText{String{reason}};
    event.severity = state == ServerState::Running ? severity_of_return : severity;
    event.set({0, "SystemState"}, state);
    return event;
}

/// Returns Good for a state in which the sources are used.
StatusCode obstacle_of_sources(ServerState state)
{
    switch (state) {
    case ServerState::Suspended:
        return status::Bad_OutOfService;
    case ServerState::Failed:
        return status::Bad_ServerHalted;
    default:
        return status::Good;
    }
}

} // namespace

void Server::Impl::enter(ServerState state, std::string_view reason, DateTime return_time)
{
    life.state = state;
    life.return_time = return_time;
    if (state != ServerState::Shutdown) { // which leaves them unchanged
        sources.suspend(obstacle_of_sources(state));
    }
    const auto queue = events->queue();
    if (queue != nullptr && address_space.find(id::SystemStatusChangeEventType) != model::no_node) {
        static_cast<void>(queue->raise(state_event(state, reason)));
        events->handle_raised();
    }
}

bool RunningServer::change_state(ServerState state, std::string_view reason,
                                 DateTime return_time) const
{
    const bool is_running = state == ServerState::Running;
    if (impl_->is_ending() || (impl_->is_shutting_down() && !is_running) ||
        (!is_running && state != ServerState::Suspended && state != ServerState::Failed)) {
        return false;
    }
    if (is_running && impl_->life.state == state) {
        return true;
    }
    const std::string_view name =
        is_running ? "running" : (state == ServerState::Failed ? "failed" : "suspended");
    impl_->log(is_running ? LogLevel::Info : LogLevel::Warning, "server",
               std::string{name} + ": " + printable(reason));
    impl_->countdown_heir = nullptr;
    impl_->shutdown_deadline = no_deadline;
    impl_->enter(state, reason, is_running ? DateTime{} : return_time);
    impl_->sweep();
    return true;
}

ServerState RunningServer::state() const
{
    return impl_->life.state;
}

bool RunningServer::begin_shutdown(std::string_view reason, std::chrono::seconds delay,
                                   DateTime return_time) const
{
    if (impl_->is_ending()) {
        return false;
    }
    impl_->begin_shutdown(impl_->latest, reason, delay, return_time);
    return true;
}

bool RunningServer::begin_countdown(std::string_view reason, std::chrono::seconds delay,
                                    DateTime return_time, CountdownHeir& heir) const
{
    const bool begins = begin_shutdown(reason, delay, return_time);
    if (begins) {
        impl_->countdown_heir = &heir;
    }
    return begins;
}

void Server::begin_shutdown(TimePoint now, std::string_view reason)
{
    if (!impl_->is_ending()) {
        impl_->begin_shutdown(now, reason, impl_->config.shutdown_delay, DateTime{});
    }
}

void Server::Impl::begin_shutdown(TimePoint now, std::string_view reason,
                                  std::chrono::milliseconds delay, DateTime return_time)
{
    log(LogLevel::Info, "server", "shutdown: " + printable(reason));
    countdown_heir = nullptr;
    life.shutdown_reason = reason;
    life.shutdown_time = {environment.wall_clock->now().ticks +
                          delay.count() * (DateTime::ticks_per_second / 1000)};
    shutdown_deadline = now + delay;
    for (detail::PeerLink* link : links) {
        link->begin_shutdown();
    }
    enter(ServerState::Shutdown, reason, return_time);
    sweep();
}

void Server::Impl::finish_shutdown()
{
    shutdown_deadline = no_deadline;
    while (detail::Session* session = sessions.any()) {
        close_session(*session, status::Bad_Shutdown, false);
    }
    for (detail::PeerLink* link : links) {
        link->close(status::Bad_Shutdown, "the server stops");
    }
    CountdownHeir* const heir = std::exchange(countdown_heir, nullptr);
    if (heir != nullptr && heir->countdown_ended() == ServerState::Failed) {
        enter(ServerState::Failed, life.shutdown_reason, {});
    }
}

bool Server::is_stopped() const
{
    return impl_->is_shutting_down() &&
           std::all_of(impl_->links.begin(), impl_->links.end(), [](const detail::PeerLink* link) {
               return link->is_closed() && link->output().empty();
           });
}

} // namespace busbar::server
