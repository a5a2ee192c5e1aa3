#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <busbar/model/address_space.hpp>
#include <busbar/server/environment.hpp>
#include <busbar/server/event.hpp>
#include <busbar/server/event_limits.hpp>

#include "event_fields.hpp"
#include "notifiers.hpp"
#include "raised_event.hpp"

namespace busbar::server::detail {

/// Receives the events that reach a notifier. Keeps its address while it is registered.
class EventReceiver {
public:
    explicit EventReceiver(model::NodeHandle notifier) : notifier_{notifier} {}
    EventReceiver(const EventReceiver&) = delete;
    EventReceiver& operator=(const EventReceiver&) = delete;

    [[nodiscard]] model::NodeHandle notifier() const { return notifier_; }
    /// An event has reached the notifier.
    virtual void deliver(const RaisedEvent& event) = 0;
    /// Events were lost on their way here.
    virtual void tell_of_loss() = 0;

    virtual ~EventReceiver() = default;

private:
    friend class Events;
    static constexpr std::size_t nowhere = SIZE_MAX;

    model::NodeHandle notifier_;
    /// Index among the receivers of its notifier.
    std::size_t place_{nowhere};
};

/// The events of a server: takes raised events and passes them to the receivers of all notifiers
/// that they reach. Lives on the server's thread; other threads use only the queue.
class Events {
public:
    Events(const ServerEnvironment& environment, const model::AddressSpace& space,
           const EventLimits& limits);
    Events(const Events&) = delete;
    Events& operator=(const Events&) = delete;
    ~Events();

    [[nodiscard]] const std::shared_ptr<EventQueue>& queue() const { return queue_; }
    [[nodiscard]] EventFields& fields() { return fields_; }
    [[nodiscard]] const EventLimits& limits() const { return limits_; }

    /// Registers a receiver for the events of its notifier, until it is removed.
    void add(EventReceiver& receiver);
    void remove(EventReceiver& receiver);

    /// Delivers the events that application threads have raised.
    void handle_raised();
    /// Delivers an event of the server itself. Bad_TypeDefinitionInvalid, with no effect, if the
    /// address space has no such event type.
    Result<void> raise(Event event);
    /// Returns the EventQueueOverflowEventType for a receiver that lost events (Part 5, 6.4.34).
    [[nodiscard]] std::unique_ptr<const RaisedEvent> overflow_event();

    /// Number of events that were raised and delivered.
    [[nodiscard]] std::uint64_t raised() const { return raised_; }

private:
    bool raise_next();
    void deliver(const RaisedEvent& event);
    void tell_of_loss();
    [[nodiscard]] ByteString next_event_id();
    [[nodiscard]] Received received() const;

    const ServerEnvironment* environment_;
    const model::AddressSpace* space_;
    EventLimits limits_;
    std::shared_ptr<EventQueue> queue_;
    EventFields fields_;
    Notifiers notifiers_;
    /// By the index of the notifier, which may belong to another node by now: receivers know their
    /// own.
    std::unordered_map<model::NodeIndex, std::vector<EventReceiver*>> receivers_;
    /// First half of all EventIds; the other half counts them.
    std::uint64_t id_prefix_{0};
    std::uint64_t raised_{0};
    std::uint64_t event_ids_{0};
    std::uint64_t dropped_{0};
};

} // namespace busbar::server::detail
