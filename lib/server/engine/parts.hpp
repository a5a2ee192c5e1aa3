#pragma once

#include <cstdint>
#include <memory>

#include <busbar/core/node_id.hpp>
#include <busbar/server/event.hpp>

#include "server/rights/live_values.hpp"

/// The interfaces of the parts that a Core's server may lack (see modules.hpp): the defaults do
/// nothing.
namespace busbar::server::detail {

class Session;

/// The state that a module keeps for its services.
class ModulePart {
public:
    ModulePart() = default;
    ModulePart(const ModulePart&) = delete;
    ModulePart& operator=(const ModulePart&) = delete;
    virtual ~ModulePart() = default;
};

class EventPart : public ModulePart {
public:
    /// Null if there are no events.
    [[nodiscard]] virtual std::shared_ptr<EventQueue> queue() const { return nullptr; }
    /// Delivers the events that application threads have raised.
    virtual void handle_raised() {}

    /// True if nodes or references were added or removed of which clients must be notified.
    [[nodiscard]] virtual bool has_model_changes() const { return false; }
    virtual void announce_model_changes() {}
    /// The properties of the node have another meaning (Part 3, 9.33).
    virtual void announce_semantics(const NodeId&) {}
};

class DiagnosticsPart : public ModulePart {
public:
    /// A session was activated, perhaps not for the first time.
    virtual void add(const Session&) {}
    virtual void remove(const Session&) {}
    /// EnabledFlag may have been changed.
    virtual void take_flag() {}
};

} // namespace busbar::server::detail
