#include "events.hpp"

#include <array>
#include <bit>

#include <busbar/core/detail/guarded.hpp>
#include <busbar/core/text.hpp>

namespace busbar::server::detail {

namespace {

std::uint64_t random_prefix(crypto::Random& random)
{
    std::array<std::byte, 8> bytes{};
    static_cast<void>(random.fill(bytes)); // without randomness it is zero, which works as well
    return std::bit_cast<std::uint64_t>(bytes);
}

} // namespace

Events::Events(const ServerEnvironment& environment, const model::AddressSpace& space,
               const EventLimits& limits)
    : environment_{&environment}, space_{&space}, limits_{limits},
      queue_{std::make_shared<EventQueue>(*environment.wall_clock, environment.waker,
                                          limits.max_raised_events)},
      fields_{space}, notifiers_{space, limits.max_notifiers}, id_prefix_{random_prefix(
                                                                   *environment.random)}
{
}

Events::~Events()
{
    queue_->close();
}

void Events::add(EventReceiver& receiver)
{
    auto& receivers = receivers_[receiver.notifier().index];
    receiver.place_ = receivers.size();
    receivers.push_back(&receiver);
}

void Events::remove(EventReceiver& receiver)
{
    if (receiver.place_ == EventReceiver::nowhere) {
        return;
    }
    // The last one takes its place, so that the cost does not depend on their number.
    const auto found = receivers_.find(receiver.notifier().index);
    auto& receivers = found->second;
    receivers.back()->place_ = receiver.place_;
    receivers[receiver.place_] = receivers.back();
    receivers.pop_back();
    receiver.place_ = EventReceiver::nowhere;
    if (receivers.empty()) {
        receivers_.erase(found);
    }
}

void Events::handle_raised()
{
    queue_->begin();
    bool is_lost = false;
    // Processes all present events, as the queue has less than twice the requested places. Events
    // that are raised meanwhile wake the server again: other work gets its turn first.
    bool is_there = true;
    for (std::size_t left = 2 * limits_.max_raised_events; left > 0 && is_there; --left) {
        const StatusCode thrown = busbar::detail::guarded(*environment_->log, "an Event",
                                                          [&] { is_there = raise_next(); });
        is_lost = is_lost || thrown.is_bad();
    }
    if (const std::uint64_t dropped = queue_->dropped(); dropped != dropped_ || is_lost) {
        dropped_ = dropped;
        tell_of_loss();
    }
}

/// Returns false if there is none.
bool Events::raise_next()
{
    Event event;
    if (!queue_->next(event)) {
        return false;
    }
    const NodeId type = event.event_type;
    if (!raise(std::move(event))) {
        environment_->log->write(LogLevel::Warning, "event",
                                 "was dropped: " + printable(to_string(type)) +
                                     " is not an event type");
    }
    return true;
}

Result<void> Events::raise(Event event)
{
    const model::NodeIndex type = space_->find(event.event_type);
    if (!space_->is_subtype_of(type, id::BaseEventType)) {
        return fail(status::Bad_TypeDefinitionInvalid);
    }
    ++raised_;
    deliver(RaisedEvent{std::move(event), type, next_event_id(), received()});
    return {};
}

void Events::deliver(const RaisedEvent& event)
{
    if (receivers_.empty()) {
        return;
    }
    for (const model::NodeIndex notifier : notifiers_.above(space_->find(event.source_node()))) {
        const auto found = receivers_.find(notifier);
        if (found == receivers_.end()) {
            continue;
        }
        for (EventReceiver* const receiver : found->second) {
            if (space_->handle(notifier) != receiver->notifier()) {
                continue;
            }
            // A receiver without memory does not affect the others.
            const StatusCode thrown = busbar::detail::guarded(*environment_->log, "an Event",
                                                              [&] { receiver->deliver(event); });
            if (thrown.is_bad()) {
                busbar::detail::attempt([&] { receiver->tell_of_loss(); });
            }
        }
    }
}

void Events::tell_of_loss()
{
    for (const auto& [notifier, receivers] : receivers_) {
        for (EventReceiver* const receiver : receivers) {
            busbar::detail::attempt([&] { receiver->tell_of_loss(); });
        }
    }
}

std::unique_ptr<const RaisedEvent> Events::overflow_event()
{
    Event event;
    event.event_type = NodeId{0, id::EventQueueOverflowEventType};
    event.source_name = "Internal/EventQueueOverflow";
    event.message = LocalizedText{"en", "Events were lost"};
    // A small namespace 0 may lack the type; only its NodeId is needed here.
    const model::NodeIndex type = space_->find(event.event_type);
    return std::make_unique<const RaisedEvent>(std::move(event), type, next_event_id(), received());
}

Received Events::received() const
{
    return {environment_->wall_clock->now(), environment_->wall_clock->time_zone()};
}

ByteString Events::next_event_id()
{
    const std::array<std::uint64_t, 2> parts{id_prefix_, ++event_ids_};
    return ByteString{std::as_bytes(std::span{parts})};
}

} // namespace busbar::server::detail
