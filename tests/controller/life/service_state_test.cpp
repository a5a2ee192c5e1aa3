#include <catch2/catch.hpp>

#include "life_fixture.hpp"

namespace service_state_test {

// Table 4-1-4, row by row.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::damaged;
using busbar::test::LifeFixture;
using busbar::test::not_used;
using busbar::test::Texts;

TEST_CASE_METHOD(LifeFixture, "Stopped during startup state (4-1-4)")
{
    life.power_on();
    CHECK(server.take() == Texts{"initialize"});
    CHECK(life.operating_status() == OperatingStatus::Initializing);
}

TEST_CASE_METHOD(LifeFixture, "Executed in PROGRAM mode and in RUN mode (4-1-4)")
{
    life.mode_changed(GENERATE(MachineMode::Program, MachineMode::Run));
    start();
    life.mode_changed(MachineMode::Run);
    life.mode_changed(MachineMode::Program);
    CHECK(server.take().empty());
    CHECK(status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "Stopped while a project is downloaded (4-1-4)")
{
    start();
    life.download_begins();
    CHECK(server.take() == Texts{"suspend"});
    CHECK(status() == "Preparing");
    CHECK(log.take().empty());
    life.download_done(used());
    CHECK(server.take() == Texts{"prepare 4840"});
    finish_preparation();
    CHECK(status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "Executed during online editing (4-1-4)")
{
    start();
    life.online_edit();
    CHECK(server.take() == Texts{"add variables"});
    CHECK(status() == "Running");
    CHECK(log.take().empty());
}

TEST_CASE_METHOD(LifeFixture, "Stopped during restore operation and after it (4-1-4)")
{
    start();
    life.restore_begins();
    CHECK(server.take() == Texts{"suspend"});
    CHECK(status() == "Preparing");
    life.restore_done(true);
    CHECK(server.take() == Texts{"stop"});
    CHECK(status() == "Shutdown");
    life.stopped();
    CHECK(log.take() == Texts{"ServerShutDown"});
    CHECK(life.is_restart_due());
    life.download_begins();
    life.download_done(used());
    CHECK(status() == "Shutdown");
    life.power_on();
    life.initialized(used());
    finish_preparation();
    CHECK_FALSE(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture, "A restore that was refused lets the server go on (4-1-4)")
{
    start();
    life.restore_begins();
    life.restore_done(false);
    finish_preparation();
    CHECK(status() == "Running");
    CHECK_FALSE(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture, "A restore needs a restart also where no server runs (4-1-4)")
{
    life.power_on();
    life.initialized(not_used);
    life.restore_begins();
    life.restore_done(true);
    CHECK(status() == "---");
    CHECK(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture, "Stopped during Clear All Memory and after it (4-1-4)")
{
    start();
    REQUIRE(life.clear_begins());
    CHECK(server.take() == Texts{"suspend"});
    CHECK(status() == "Preparing");
    life.clear_done(true);
    CHECK(server.take() == Texts{"stop"});
    CHECK(status() == "Shutdown");
    life.stopped();
    CHECK(life.is_restart_due());
    CHECK_FALSE(life.status({}).is_used);
}

TEST_CASE_METHOD(LifeFixture, "Clear All Memory is for PROGRAM mode (8-3)")
{
    start();
    life.mode_changed(MachineMode::Run);
    const auto begun = life.clear_begins();
    REQUIRE_FALSE(begun);
    CHECK(begun.error().status == status::Bad_InvalidState);
    CHECK(server.take().empty());
    CHECK(LifeFixture::status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "No restart after Clear All Memory where no server is used (8-3)")
{
    life.power_on();
    life.initialized(not_used);
    REQUIRE(life.clear_begins());
    life.clear_done(true);
    CHECK_FALSE(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture, "Clear All Memory that failed lets the server go on (8-3)")
{
    start();
    REQUIRE(life.clear_begins());
    life.clear_done(false);
    finish_preparation();
    CHECK(status() == "Running");
    CHECK(life.status({}).is_used);
}

TEST_CASE_METHOD(LifeFixture, "Executed in a major fault, but for a CPU error (4-1-4)")
{
    start();
    life.major_fault();
    CHECK(server.take().empty());
    CHECK(status() == "Running");
    CHECK(life.served_clients() == ServedClients::All);
    CHECK(log.take() == Texts{"MachineFault Major fault CPU Unit"});
    CHECK_FALSE(life.has_program_going());
    life.watchdog();
    CHECK(server.take() == Texts{"stop"});
    CHECK(status() == "Shutdown");
    CHECK(log.take() == Texts{"MachineFault Major fault CPU watchdog"});
    life.stopped();
    life.power_on();
    CHECK(life.has_program_going());
}

TEST_CASE_METHOD(LifeFixture, "Executed in a partial fault, but for the server's (4-1-4)")
{
    start();
    life.partial_fault(FaultOrigin::Elsewhere);
    CHECK(server.take().empty());
    CHECK(status() == "Running");
    CHECK(log.take() == Texts{"MachineFault Partial fault CPU Unit"});
    life.partial_fault(FaultOrigin::OpcUaServer);
    CHECK(server.take() == Texts{"stop"});
    CHECK(status() == "Halt error");
    CHECK(life.served_clients() == ServedClients::Administrators);
    CHECK(life.halt_reason() == "OPC UA System Error: a partial fault of the OPC UA server");
    CHECK(life.has_program_going());
}

TEST_CASE_METHOD(LifeFixture, "Executed in a minor fault, but for errors that halt it (4-1-4)")
{
    start();
    life.minor_fault(FaultOrigin::Elsewhere);
    life.minor_fault(FaultOrigin::OpcUaServer);
    CHECK(server.take().empty());
    CHECK(status() == "Running");
    CHECK(log.take() == Texts{"MachineFault Minor fault CPU Unit",
                              "MachineFault Minor fault OPC UA Server"});
    CHECK(life.has_program_going());
    life.download_begins();
    life.download_done(damaged());
    CHECK(status() == "Halt error");
}

} // namespace service_state_test
