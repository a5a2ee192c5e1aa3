#pragma once

#include <busbar/harness/chance.hpp>
#include <busbar/harness/client_host.hpp>
#include <busbar/harness/link.hpp>
#include <busbar/harness/scheduler.hpp>
#include <busbar/harness/server_host.hpp>
#include <busbar/harness/world.hpp>

/// What the simulation takes from the harness.
namespace busbar::test {

using harness::Alarm;
using harness::Chance;
using harness::ClientHost;
using harness::EngineWatch;
using harness::JumpingClock;
using harness::Link;
using harness::LinkEnd;
using harness::LinkFilter;
using harness::Scheduler;
using harness::ServerHost;
using harness::Side;
using harness::Weather;
using harness::World;

} // namespace busbar::test
