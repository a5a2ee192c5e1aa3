#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <busbar/server/environment.hpp>
#include <busbar/server/event.hpp>
#include <busbar/server/event_limits.hpp>

#include "event_fields.hpp"
#include "event_receiver.hpp"
#include "notifiers.hpp"

namespace busbar::server::detail {

/// The events of a server: takes what was raised and hands it to the receivers of all notifiers
/// that it reaches. Lives on the server's thread; only the queue is for others.
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

    /// Takes part in what its notifier gets, until it is removed.
    void add(EventReceiver& receiver);
    void remove(EventReceiver& receiver);

    /// Hands on what application threads have raised.
    void handle_raised();
    /// Hands on an event of the server's own. Bad_TypeDefinitionInvalid, and nothing is done, if
    /// the address space has no such event type.
    Result<void> raise(Event event);
    /// The EventQueueOverflowEventType for a receiver that lost events (Part 5, 6.4.34).
    [[nodiscard]] std::unique_ptr<const RaisedEvent> overflow_event();

    /// Events that were raised and handed on.
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
    /// By the index of the notifier, which another node may have by now: receivers know whose it
    /// was.
    std::unordered_map<model::NodeIndex, std::vector<EventReceiver*>> receivers_;
    /// First half of all EventIds; the other counts them.
    std::uint64_t id_prefix_{0};
    std::uint64_t raised_{0};
    std::uint64_t event_ids_{0};
    std::uint64_t dropped_{0};
};

} // namespace busbar::server::detail
