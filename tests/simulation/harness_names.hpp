#pragma once

#include <busbar/harness/chance.hpp>
#include <busbar/harness/link.hpp>
#include <busbar/harness/scheduler.hpp>
#include <busbar/harness/server_host.hpp>

/// What the simulation takes from the harness.
namespace busbar::test {

using harness::Alarm;
using harness::Chance;
using harness::JumpingClock;
using harness::Link;
using harness::LinkEnd;
using harness::Scheduler;
using harness::ServerHost;
using harness::Side;
using harness::Weather;

} // namespace busbar::test
