#pragma once

#include <cstdint>
#include <memory>

#include <busbar/core/node_id.hpp>
#include <busbar/server/event.hpp>

#include "server/rights/live_values.hpp"

/// What a Core knows of the parts that its server may be without (see modules.hpp): as they are
/// here they do nothing.
namespace busbar::server::detail {

class Session;

/// Whatever a module keeps for its services.
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
    /// Hands on what application threads have raised.
    virtual void handle_raised() {}

    /// True if nodes or references came or went of which clients have to be told.
    [[nodiscard]] virtual bool has_model_changes() const { return false; }
    virtual void announce_model_changes() {}
    /// The properties of the node mean something else (Part 3, 9.33).
    virtual void announce_semantics(const NodeId&) {}
};

class DiagnosticsPart : public ModulePart {
public:
    /// A session was activated, perhaps not for the first time.
    virtual void add(const Session&) {}
    virtual void remove(const Session&) {}
    /// Somebody may have changed EnabledFlag.
    virtual void take_flag() {}
};

} // namespace busbar::server::detail
