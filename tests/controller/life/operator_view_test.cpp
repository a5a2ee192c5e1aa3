#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/crypto/store_limits.hpp>
#include <busbar/server/product_limits.hpp>
#include <busbar/server/subscription_limits.hpp>

#include "logged_life.hpp"

namespace operator_view_test {

// What people who run a controller set and see of its server.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::LoggedLife;
using busbar::test::Texts;

TEST_CASE("Clients have five sessions, lists have 32 certificates (1-2-2)")
{
    for (const server::ServerLimits& limits : {server::nj501_limits(), server::nx102_limits()}) {
        CHECK(limits.max_sessions == 5);
    }
    for (const server::SubscriptionLimits& limits :
         {server::nj501_subscriptions(), server::nx102_subscriptions()}) {
        CHECK(limits.max_subscriptions == 100);
        CHECK(limits.max_items == 2'000);
    }
    for (const crypto::StoreLimits& limits :
         {crypto::nj501_store_limits(), crypto::nx102_store_limits()}) {
        CHECK(limits.max_certificates == 32);
        CHECK(limits.max_rejected == 32);
    }
}

TEST_CASE_METHOD(LoggedLife, "Server settings are made offline, security settings online (3-2-1)")
{
    MachineSettings settings{memory, "server.json", "security.json", "settings"};
    ServerSettings made = used();
    made.port = 4'850;
    const std::string project = document_of(made);
    start();
    server.calls.clear();

    life.download_begins();
    const auto downloaded = read_server_settings(project, "project");
    REQUIRE(downloaded);
    REQUIRE(settings.transfer(*downloaded, life.mode()));
    life.download_done(settings.server());
    finish_preparation();
    CHECK(server.take() == Texts{"suspend", "prepare 4850", "run"});

    SecuritySettings security = settings.security();
    security.allows_anonymous = true;
    REQUIRE(settings.transfer(security, life.mode()));
    life.security_changed();
    CHECK(server.take() == Texts{"reconfigure 4850"});
    CHECK(settings.server() == made);
}

TEST_CASE_METHOD(LoggedLife, "The status of the server is seen, and the server shut down (3-2-7)")
{
    const auto seen = [&](std::string_view item) {
        const auto all = status_lines(life.status({3, 2}));
        const auto line =
            std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == item; });
        return line == all.end() ? std::string{} : line->value;
    };
    start();
    CHECK(seen("Server operating status") == "Running");
    CHECK(seen("End point") == busbar::test::life_url);
    CHECK(seen("Number of connected clients") == "3");
    CHECK(seen("Number of connected users") == "2");
    server.calls.clear();
    CHECK(life.shut_down("somebody shuts the server down") == ShutdownAnswer::Begun);
    CHECK(server.take() == Texts{"stop"});
    CHECK(server.reason == "somebody shuts the server down");
    CHECK(seen("Server operating status") == "Shutdown");
    CHECK(seen("End point") == "---");
    life.stopped();
    CHECK(life.shut_down("once more") == ShutdownAnswer::ShutDown);
}

TEST_CASE_METHOD(LoggedLife, "What stops the server, and what does not (4-1-3)")
{
    start();
    server.calls.clear();
    std::string after_reset = "Preparing";
    SECTION("a shutdown")
    {
        static_cast<void>(life.shut_down("it is to stop"));
    }
    SECTION("Use is changed to Do not use")
    {
        life.download_begins();
        life.download_done(busbar::test::not_used);
        after_reset = "---";
    }
    SECTION("a restore")
    {
        life.restore_begins();
        life.restore_done(true);
    }
    SECTION("Clear All Memory")
    {
        REQUIRE(life.clear_begins());
        life.clear_done(true);
        after_reset = "---";
    }
    SECTION("a major fault does not stop it")
    {
        life.major_fault();
        CHECK(status() == "Running");
        CHECK(server.take().empty());
        return;
    }
    CHECK(server.take().back() == "stop");
    life.stopped();
    CHECK(status() == "Shutdown");
    CHECK(events() == Texts{"95D00000", "95D10000"});
    life.reset();
    life.initialized(after_reset == "---" ? busbar::test::not_used : used());
    CHECK(status() == after_reset);
}

TEST_CASE_METHOD(LoggedLife, "The event log tells what the server does (4-2-2)")
{
    start();
    CHECK(events() == Texts{"95D00000"});
    life.download_begins();
    life.download_done(busbar::test::damaged());
    CHECK(status() == "Halt error");
    CHECK(event_log->plc_error() == PlcError{EventLevel::MinorFault, 0x35D00000});
    life.download_begins();
    life.download_done(used());
    finish_preparation();
    CHECK_FALSE(event_log->plc_error());
    life.system_error("found one");
    CHECK(event_log->plc_error() == PlcError{EventLevel::MinorFault, 0x44180000});
    static_cast<void>(life.shut_down("it is to stop"));
    life.stopped();
    life.stopped();
    life.stopped();
    CHECK(events() == Texts{"95D00000", "35D00000", "44180000", "95D10000"});
}

TEST_CASE_METHOD(LoggedLife, "The execution log tells what the server does (4-2-3)")
{
    start();
    life.address_changed();
    finish_preparation();
    life.download_begins();
    life.download_done(busbar::test::damaged());
    life.stopped();
    life.download_begins();
    life.download_done(used());
    finish_preparation();
    static_cast<void>(life.shut_down("it is to stop"));
    life.stopped();
    CHECK(logged() == Texts{"SERVER 0001 Start", "SERVER 0004 Prepare", "SERVER 0005 Run",
                            "SERVER 0004 Prepare", "SERVER 0005 Run",
                            "SERVER 0007 HaltError Configuration Error", "SERVER 0004 Prepare",
                            "SERVER 0005 Run", "SERVER 0006 Shutdown"});
}

TEST_CASE_METHOD(LoggedLife, "OPCUA_Shutdown records the shutdown and leaves the medium (A-2-5)")
{
    InstructionDesk desk;
    OpcuaShutdown block{desk};
    start();
    block(true);
    desk.serve(life, *log);
    CHECK(server.take().back() == "stop");
    // What an operator does then.
    life.stopped();
    REQUIRE(log->flush());
    desk.serve(life, *log);
    block(true);
    CHECK(block.done());
    const std::size_t steps = card.steps();
    REQUIRE(log->write_pending());
    CHECK(card.steps() == steps);
    CHECK(log->waiting() == 0);
    CHECK(logged().back() == "SERVER 0006 Shutdown");
}

} // namespace operator_view_test
