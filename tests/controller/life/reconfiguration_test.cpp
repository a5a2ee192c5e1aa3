#include <catch2/catch.hpp>

#include "life_fixture.hpp"

namespace reconfiguration_test {

using namespace busbar;
using namespace busbar::controller;
using busbar::test::damaged;
using busbar::test::LifeFixture;
using busbar::test::not_used;
using busbar::test::Texts;

TEST_CASE_METHOD(LifeFixture, "What reconfigures a server that runs (4-2-5)")
{
    start();
    const auto& [change, reason] = GENERATE(table<void (LifeCycle::*)(), std::string>({
        {&LifeCycle::address_changed, "the controller's address changes"},
        {&LifeCycle::certificate_renewed, "the server has a new certificate"},
        {&LifeCycle::security_changed, "the security settings change"},
    }));
    (life.*change)();
    CHECK(server.take() == Texts{"reconfigure 4840"});
    CHECK(server.reason == reason);
    CHECK(status() == "Preparing");
    CHECK(log.take() == Texts{"ServerPreparing"});
    finish_preparation();
    CHECK(server.take() == Texts{"run"});
    CHECK(status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "Clients learn why a server goes and when it is back (4-2-5)")
{
    life.power_on();
    life.initialized(used());
    clock.time.ticks += 25 * DateTime::ticks_per_second / 10; // 2.5 s
    finish_preparation();
    life.download_begins();
    CHECK(server.reason == "a project is downloaded to the controller");
    CHECK(server.return_time.unix_seconds() == clock.time.unix_seconds() + 60 + 3);
    life.download_done(used());
    finish_preparation(); // in no time: counts as a second
    life.address_changed();
    CHECK(server.return_time.unix_seconds() == clock.time.unix_seconds() + 1);
    finish_preparation();
    life.restore_begins();
    CHECK(server.reason == "a backup is restored to the controller");
    life.restore_done(true);
    CHECK(server.return_time.is_null());
}

TEST_CASE_METHOD(LifeFixture, "A change while the server is prepared prepares it anew (4-2-5)")
{
    life.power_on();
    life.initialized(used());
    const std::uint32_t first = server.number;
    forget();
    life.address_changed();
    CHECK(server.take() == Texts{"prepare 4840"});
    life.prepared(first, "opc.tcp://old");
    life.preparation_failed(first, PreparationFailure::Start, "late");
    CHECK(status() == "Preparing");
    finish_preparation();
    CHECK(status() == "Running");
    CHECK(life.status({}).end_point == busbar::test::life_url);
}

TEST_CASE_METHOD(LifeFixture, "A download while the server is prepared begins anew (4-2-5)")
{
    life.power_on();
    life.initialized(used());
    const std::uint32_t first = server.number;
    forget();
    life.download_begins();
    CHECK(server.take() == Texts{"suspend"});
    life.prepared(first, "opc.tcp://old");
    CHECK(status() == "Preparing");
    life.download_done(used());
    finish_preparation();
    CHECK(status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "What is edited while the server is prepared is added then (4-2-5)")
{
    life.power_on();
    life.initialized(used());
    forget();
    life.online_edit();
    CHECK(server.take().empty());
    finish_preparation();
    CHECK(server.take() == Texts{"run", "add variables"});
    life.address_changed();
    finish_preparation();
    CHECK(server.take() == Texts{"reconfigure 4840", "run"});
}

TEST_CASE_METHOD(LifeFixture, "A reset shuts the server down before (7-3-3)")
{
    start();
    life.reset();
    CHECK(server.take() == Texts{"stop"});
    CHECK(server.reason == "the controller is reset");
    CHECK(server.return_time.unix_seconds() > clock.time.unix_seconds());
    CHECK(status() == "Shutdown");
    life.stopped();
    CHECK(log.take() == Texts{"ServerShutDown"});
    CHECK(server.take() == Texts{"initialize"});
    CHECK(status() == "Initializing");
}

TEST_CASE_METHOD(LifeFixture, "A reset waits for a shutdown that is under way (7-3-3)")
{
    start();
    life.shut_down("maintenance");
    life.reset();
    CHECK(server.take() == Texts{"stop"});
    life.stopped();
    CHECK(server.take() == Texts{"initialize"});
}

TEST_CASE_METHOD(LifeFixture, "A late answer does not complete another shutdown (7-3-4)")
{
    start();
    life.download_begins();
    life.download_done(damaged()); // halts: one stop
    life.shut_down("maintenance"); // and another one
    life.stopped();
    CHECK_FALSE(life.has_stopped());
    life.stopped();
    CHECK(life.has_stopped());
}

TEST_CASE_METHOD(LifeFixture, "Power and the medium are the program's business (7-4-1)")
{
    start();
    life.medium_changed(false);
    life.medium_changed(true);
    life.power_going();
    CHECK(server.take() == Texts{"out", "in", "save"});
    CHECK(status() == "Running");
}

TEST_CASE_METHOD(LifeFixture, "The status of the server (4-2-1)")
{
    const auto lines = [&](std::size_t clients, std::size_t users) {
        Texts all;
        for (const StatusLine& line : status_lines(life.status({clients, users}))) {
            all.push_back(std::string{line.name} + ": " + line.value);
        }
        return all;
    };
    life.power_on();
    CHECK(lines(0, 0)[1] == "Server operating status: Initializing");
    CHECK(lines(0, 0)[3] == "Number of connected clients: ---");
    life.initialized(used());
    CHECK(lines(0, 0) == Texts{"OPC UA Server: Use", "Server operating status: Preparing",
                               "End point: ---", "Number of connected clients: 0",
                               "Number of connected users: 0"});
    finish_preparation();
    CHECK(lines(3, 2) == Texts{"OPC UA Server: Use", "Server operating status: Running",
                               "End point: opc.tcp://192.168.250.1:4840",
                               "Number of connected clients: 3", "Number of connected users: 2"});
    life.download_begins();
    CHECK(lines(3, 2)[2] == "End point: ---");
    life.download_done(not_used);
    CHECK(lines(0, 0)[0] == "OPC UA Server: Do not use");
    CHECK(lines(0, 0)[1] == "Server operating status: Shutdown");
    life.system_error("no effect any more");
    CHECK(lines(0, 0)[1] == "Server operating status: Shutdown");
}

} // namespace reconfiguration_test
