#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/model/address_space.hpp>

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

} // namespace busbar::server::detail
