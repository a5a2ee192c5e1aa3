#pragma once

#include <busbar/core/api.hpp>

namespace busbar::harness {

/// Is notified when the server's own code begins to run and when it has ended: for faults that
/// shall happen to the server alone, such as memory that runs out (failing_memory.hpp). The calls
/// do not nest.
class BUSBAR_API EngineWatch {
public:
    EngineWatch() = default;
    EngineWatch(const EngineWatch&) = delete;
    EngineWatch& operator=(const EngineWatch&) = delete;
    virtual ~EngineWatch() = default;

    /// Called before the host calls into the server.
    virtual void enter() = 0;
    /// Called after it.
    virtual void leave() = 0;
};

} // namespace busbar::harness
