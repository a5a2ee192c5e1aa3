#pragma once

#include <cstdint>

#include <busbar/client/once_log.hpp>
#include <busbar/client/registration.hpp>

#include "harness_names.hpp"
#include "trace.hpp"

namespace busbar::test {

/// A server that keeps itself registered with a discovery server, whatever that answers or keeps to
/// itself: each attempt ends, the next one comes within the interval, and so does a farewell.
class RegistrationWatch {
public:
    RegistrationWatch(World& world, Trace& trace);

    /// Does what is due, and looks whether something waits for longer than it may; call it each few
    /// seconds. Now and then the server is unregistered and registered again.
    void check();
    /// The discovery server is well from now on: the server stays registered.
    void begin_recovery() { may_leave_ = false; }
    /// The discovery server has been well for longer than the interval.
    void check_recovery();

private:
    void violation(const std::string& what);

    World& world_;
    Trace& trace_;
    Chance chance_;
    NullLog null_;
    client::OnceLog log_;
    harness::SeededRandom random_;
    ClientHost host_;
    client::Registration registration_;
    TimePoint stopped_{no_deadline}; // since when it is asked to end
    TimePoint planned_;              // when it last had a next step
    bool may_leave_{true};
};

} // namespace busbar::test
