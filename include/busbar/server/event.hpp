#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <busbar/core/api.hpp>
#include <busbar/core/clock.hpp>
#include <busbar/core/detail/bounded_ring.hpp>
#include <busbar/core/detail/hand_over.hpp>
#include <busbar/core/types.hpp>
#include <busbar/server/waker.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server {

/// A field of an event beyond those of BaseEventType: the BrowseNames that lead from the event's
/// type to it, and its value. A StatusCode in place of a value says why there is none now (Part 4,
/// 7.22.3).
struct EventField {
    std::vector<QualifiedName> path;
    Variant value;
};

/// An event that an application raises (Part 5, 6.4.2):
///
///     Event event;
///     event.event_type = NodeId{2, 1001U};
///     event.source_node = press;
///     event.source_name = "Press 4";
///     event.message = LocalizedText{"en", "Pressure too high"};
///     event.severity = 700;
///     event.set({2, "Pressure"}, 8.5);
///     server.raise_event(std::move(event));
///
/// The server sets EventId and ReceiveTime. An ordinary value.
struct Event {
    /// BaseEventType or a subtype in the address space.
    NodeId event_type{0, id::BaseEventType};
    /// The subject of the event. It reaches the notifiers above this node, and always the Server
    /// object.
    NodeId source_node{0, id::Server};
    String source_name;
    LocalizedText message;
    /// 1 to 1,000; other values are limited to that range.
    std::uint16_t severity{1};
    /// The time when it occurred; null means the time when it is raised.
    DateTime time;
    /// The node that represents the event in the address space, a Condition; most events have none.
    NodeId instance;
    std::vector<EventField> fields;

    /// Adds a field that the event type has.
    Event& set(QualifiedName name, Variant value)
    {
        std::vector<QualifiedName> path;
        path.push_back(std::move(name));
        return set(std::move(path), std::move(value));
    }
    /// Adds a field that lies deeper than the Properties of the type: {{0, "EnabledState"}, {0,
    /// "Id"}}.
    Event& set(std::vector<QualifiedName> path, Variant value)
    {
        fields.push_back({std::move(path), std::move(value)});
        return *this;
    }
};

/// Events on their way from any thread to the server's thread. Holds a fixed number, so that a
/// storm of events costs neither memory nor the time of the threads that raise them.
class BUSBAR_API EventQueue {
public:
    /// Created by the server. `wall_clock` and `waker`, which may be null, must be valid until
    /// close(). Room for `capacity` events, rounded up to a power of two.
    EventQueue(const WallClock& wall_clock, Waker* waker, std::size_t capacity);
    EventQueue(const EventQueue&) = delete;
    EventQueue& operator=(const EventQueue&) = delete;
    ~EventQueue();

    /// Called from any thread. Never blocks, and calls nothing except the Waker. False if the
    /// server is destroyed or there is no room, which dropped() counts and clients learn of by an
    /// EventQueueOverflowEventType.
    bool raise(Event event);
    /// Raises an event that was created beforehand, at `time`. Nothing is allocated or freed here
    /// as long as the caller keeps `event`: for a thread that controls a machine.
    bool raise(const std::shared_ptr<const Event>& event, DateTime time);
    /// Number of events that were dropped for lack of room.
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

    // Called on the server's thread.

    /// Call it before a series of next(): events that are raised later wake the server again.
    void begin() { is_awake_ = false; }
    /// Takes the oldest event; false if there is none.
    [[nodiscard]] bool next(Event& event);
    /// Refuses events from now on. Clock and Waker are not used any more afterwards.
    void close();

private:
    /// An event on its way; if `made` is set, that one, which was created beforehand, at `time`.
    struct Raised {
        Event event;
        std::shared_ptr<const Event> made;
        DateTime time;
    };

    template <typename Put>
    void push(Put put, bool& is_queued);

    /// Empty once the queue is closed. A thread that raises an event uses it meanwhile.
    busbar::detail::Lent<const WallClock> wall_clock_;
    busbar::detail::WakerSlot waker_;
    busbar::detail::BoundedRing<Raised> ring_;
    std::atomic<std::uint64_t> dropped_{0};
    std::atomic<bool> is_awake_{false};
};

} // namespace busbar::server
