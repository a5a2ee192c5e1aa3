#include <catch2/catch.hpp>

#include "life_fixture.hpp"

namespace life_cycle_test {

using namespace busbar;
using namespace busbar::controller;
using busbar::test::damaged;
using busbar::test::LifeFixture;
using busbar::test::not_used;
using busbar::test::Texts;

TEST_CASE_METHOD(LifeFixture, "The server starts with power if it is used (4-1-1)")
{
    CHECK(status() == "---");
    life.power_on();
    CHECK(status() == "Initializing");
    CHECK(server.take() == Texts{"initialize"});
    CHECK(log.take().empty());

    life.initialized(used());
    CHECK(status() == "Preparing");
    CHECK(server.take() == Texts{"prepare 4840"});
    CHECK(log.take() == Texts{"ServerStarted", "ServerPreparing"});

    finish_preparation();
    CHECK(status() == "Running");
    CHECK(server.take() == Texts{"run"});
    CHECK(log.take() == Texts{"ServerRunning opc.tcp://192.168.250.1:4840"});
    CHECK_FALSE(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture, "Do not use: nothing starts (4-1-1)")
{
    life.power_on();
    life.initialized(not_used);
    CHECK(status() == "---");
    CHECK(server.take() == Texts{"initialize"});
    CHECK(log.take().empty());
    CHECK_FALSE(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture, "Use needs a restart (3-2-3)")
{
    life.power_on();
    life.initialized(not_used);
    forget();
    life.download_begins();
    life.download_done(used());
    CHECK(status() == "---");
    CHECK(server.take().empty());
    CHECK(life.is_restart_due());
    SECTION("and then starts")
    {
        life.reset();
        CHECK(server.take() == Texts{"initialize"});
        life.initialized(used());
        finish_preparation();
        CHECK(status() == "Running");
        CHECK_FALSE(life.is_restart_due());
    }
    SECTION("unless it is taken back")
    {
        life.download_begins();
        life.download_done(not_used);
        CHECK_FALSE(life.is_restart_due());
    }
}

TEST_CASE_METHOD(LifeFixture, "Do not use again stops the server and needs a restart (3-2-3)")
{
    start();
    life.download_begins();
    life.download_done(not_used);
    CHECK(status() == "Shutdown");
    CHECK(server.take() == Texts{"suspend", "stop"});
    CHECK_FALSE(life.has_stopped());
    life.stopped();
    CHECK(life.has_stopped());
    CHECK(log.take() == Texts{"ServerShutDown"});
    CHECK(life.is_restart_due());
    // Use again does not bring it back (4-1-2).
    life.download_begins();
    life.download_done(used());
    CHECK(status() == "Shutdown");
    CHECK(server.take().empty());
    CHECK(life.is_restart_due());
}

TEST_CASE_METHOD(LifeFixture,
                 "A tool shuts the server down, and only a restart brings it back (4-1-1)")
{
    start();
    CHECK(life.shut_down("maintenance until noon") == ShutdownAnswer::Begun);
    CHECK(status() == "Shutdown");
    CHECK(server.take() == Texts{"stop"});
    CHECK(server.reason == "maintenance until noon");
    CHECK(server.return_time.is_null());
    CHECK(log.take().empty());
    CHECK(life.shut_down("again") == ShutdownAnswer::ShutDown);
    life.stopped();
    CHECK(log.take() == Texts{"ServerShutDown"});
    CHECK(life.shut_down("again") == ShutdownAnswer::ShutDown);

    life.address_changed();
    life.security_changed();
    life.download_begins();
    life.download_done(used());
    life.online_edit();
    CHECK(server.take().empty());
    CHECK(status() == "Shutdown");
    life.power_on();
    life.initialized(used());
    CHECK(status() == "Preparing");
}

TEST_CASE_METHOD(LifeFixture, "The server cannot be started in Halt error (4-1-2)")
{
    life.power_on();
    life.initialized(damaged());
    CHECK(status() == "Halt error");
    CHECK(log.take() == Texts{"ServerHalted Configuration Error"});
    forget();
    life.address_changed();
    life.certificate_renewed();
    life.online_edit();
    CHECK(server.take().empty());
    CHECK(status() == "Halt error");
}

TEST_CASE_METHOD(LifeFixture, "Initializing ends where the settings say (4-2-4)")
{
    life.power_on();
    SECTION("again with another reset")
    {
        life.reset();
        CHECK(server.take() == Texts{"initialize", "initialize"});
        CHECK(status() == "Initializing");
    }
    SECTION("once")
    {
        life.initialized(used());
        life.initialized(not_used);
        CHECK(status() == "Preparing");
    }
}

TEST_CASE_METHOD(LifeFixture, "A download with wrong settings halts a server that ran (4-2-4)")
{
    start();
    life.download_begins();
    life.download_done(damaged());
    CHECK(status() == "Halt error");
    CHECK(server.take() == Texts{"suspend", "stop"});
    CHECK(log.take() == Texts{"ServerHalted Configuration Error"});
    CHECK(log.lines.back() == "the OPC UA server halts: Configuration Error: server.json: is cut");
    life.stopped();
    CHECK(status() == "Halt error");
    CHECK(log.take().empty());
}

TEST_CASE_METHOD(LifeFixture, "A download over a Halt error starts the server (9-2-2, 35D00000)")
{
    life.power_on();
    life.initialized(damaged());
    forget();
    ServerSettings settings = used();
    settings.port = 4841;
    life.download_begins();
    CHECK(status() == "Halt error");
    SECTION("if it mends the settings")
    {
        life.download_done(settings);
        CHECK(server.take() == Texts{"prepare 4841"});
        CHECK(log.take() == Texts{"ServerPreparing"});
        finish_preparation();
        CHECK(status() == "Running");
        CHECK_FALSE(life.is_restart_due());
    }
    SECTION("not if it does not")
    {
        life.download_done(damaged());
        CHECK(status() == "Halt error");
        CHECK(log.take() == Texts{"ServerHalted Configuration Error"});
    }
    SECTION("not if the server is not used any more")
    {
        life.download_done(not_used);
        CHECK(status() == "Shutdown");
    }
}

TEST_CASE_METHOD(LifeFixture, "A port in use is a Server Start Error (9-2-2, 35D00000)")
{
    life.power_on();
    life.initialized(used());
    forget();
    life.preparation_failed(server.number, PreparationFailure::Start, "port 4840 is in use");
    CHECK(status() == "Halt error");
    CHECK(server.take() == Texts{"stop"});
    CHECK(log.take() == Texts{"ServerHalted Server Start Error"});
    life.stopped();
    ServerSettings settings = used();
    settings.port = 4841;
    life.download_begins();
    life.download_done(settings);
    finish_preparation();
    CHECK(status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "Why a server halts (7-1-6)")
{
    life.power_on();
    life.initialized(used());
    forget();
    const auto& [failure, records] = GENERATE(table<PreparationFailure, Texts>({
        {PreparationFailure::Settings, {"ServerHalted Configuration Error"}},
        {PreparationFailure::Start, {"ServerHalted Server Start Error"}},
        {PreparationFailure::System, {"ServerSystemError", "ServerHalted OPC UA System Error"}},
    }));
    life.preparation_failed(server.number, failure, "why");
    CHECK(log.take() == records);
    CHECK(status() == "Halt error");
}

TEST_CASE_METHOD(LifeFixture, "A fatal error of the server takes a restart (9-2-2, 44180000)")
{
    start();
    life.system_error("the event loop ended");
    CHECK(status() == "Halt error");
    CHECK(server.take() == Texts{"stop"});
    CHECK(log.take() == Texts{"ServerSystemError", "ServerHalted OPC UA System Error"});
    CHECK(life.is_restart_due());
    life.stopped();
    life.download_begins();
    life.download_done(used());
    CHECK(status() == "Halt error");
    CHECK(server.take().empty());
    life.reset();
    CHECK(status() == "Initializing");
}

} // namespace life_cycle_test
