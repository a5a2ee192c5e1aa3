#include <catch2/catch.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <utility>

#include <busbar/controller/opcua_shutdown.hpp>
#include <busbar/controller/plc.hpp>

#include "life_fixture.hpp"

namespace opcua_shutdown_test {

using namespace busbar;
using namespace busbar::controller;
using busbar::test::LifeFixture;
using busbar::test::Texts;

namespace {

struct ShutdownFixture : LifeFixture {
    /// "done", "busy", "error 5000"; nothing while it rests.
    [[nodiscard]] static std::string outputs(const OpcuaShutdown& block)
    {
        std::string all = block.done() ? "done" : "";
        all += block.busy() ? "busy" : "";
        all += block.error() ? "error " + std::to_string(block.error_id()) : "";
        return all;
    }
    void serve() { desk.serve(life, log); }

    InstructionDesk desk;
    OpcuaShutdown block{desk};
};

constexpr std::uint16_t shut_down_code = 0x5000;
constexpr std::uint16_t initializing_code = 0x5001;
constexpr std::uint16_t not_started_code = 0x5002;

} // namespace

TEST_CASE_METHOD(ShutdownFixture, "OPCUA_Shutdown shuts the server down and says so (A-2-1)")
{
    start();
    block(false);
    CHECK(outputs(block).empty());
    block(true);
    CHECK(outputs(block) == "busy");
    CHECK(status() == "Running"); // the task does nothing of it
    serve();
    CHECK(status() == "Shutdown");
    block(true);
    CHECK(outputs(block) == "busy");
    life.stopped();
    serve();
    block(true);
    CHECK(outputs(block) == "done");
    CHECK(log.take() == Texts{"ServerShutDown"});
    block(true);
    CHECK(outputs(block) == "done");
    block(false);
    CHECK(outputs(block).empty());
}

TEST_CASE_METHOD(ShutdownFixture, "OPCUA_Shutdown starts when Execute changes to TRUE (A-2-2)")
{
    start();
    block(false);
    block(false);
    serve();
    CHECK(status() == "Running");
    block(true);
    serve();
    life.stopped();
    serve();
    block(true);
    block(true);
    serve();
    CHECK(outputs(block) == "done");
    // A second time there is nothing to shut down.
    block(false);
    block(true);
    serve();
    block(true);
    CHECK(outputs(block) == "error " + std::to_string(shut_down_code));
}

TEST_CASE_METHOD(ShutdownFixture, "OPCUA_Shutdown goes on when Execute changes to FALSE (A-2-6)")
{
    start();
    block(true);
    block(false);
    CHECK(outputs(block) == "busy");
    serve();
    life.stopped();
    serve();
    block(false);
    CHECK(outputs(block) == "done");
    block(false);
    CHECK(outputs(block).empty());
}

TEST_CASE_METHOD(ShutdownFixture, "16#5000: shut down or shutting down (A-2-4)")
{
    start();
    SECTION("shutting down")
    {
        life.shut_down("a tool");
    }
    SECTION("shut down")
    {
        life.shut_down("a tool");
        life.stopped();
    }
    log.records.clear();
    block(true);
    serve();
    block(true);
    CHECK(outputs(block) == "error " + std::to_string(shut_down_code));
    CHECK(block.error_id() == 0x5000);
    CHECK(log.take() ==
          Texts{"InstructionFailed " + std::to_string(shut_down_code) + " OPCUA_Shutdown"});
    block(false);
    CHECK(block.error_id() == 0);
}

TEST_CASE_METHOD(ShutdownFixture, "16#5001: being initialized (A-2-4)")
{
    life.power_on();
    block(true);
    serve();
    block(true);
    CHECK(block.error_id() == initializing_code);
    CHECK(log.take() ==
          Texts{"InstructionFailed " + std::to_string(initializing_code) + " OPCUA_Shutdown"});
    CHECK(status() == "Initializing");
    // Executing it again is the remedy (9-2-2).
    life.initialized(used());
    block(false);
    block(true);
    serve();
    CHECK(status() == "Shutdown");
}

TEST_CASE_METHOD(ShutdownFixture, "16#5002: not started (A-2-4)")
{
    life.power_on();
    life.initialized(ServerSettings{});
    block(true);
    serve();
    block(true);
    CHECK(block.error_id() == not_started_code);
    CHECK(log.take() ==
          Texts{"InstructionFailed " + std::to_string(not_started_code) + " OPCUA_Shutdown"});
}

TEST_CASE_METHOD(ShutdownFixture, "16#041D: more than 32 at the same time (A-2-4)")
{
    start();
    std::vector<std::unique_ptr<OpcuaShutdown>> blocks;
    for (std::size_t i = 0; i < 33; ++i) {
        blocks.push_back(std::make_unique<OpcuaShutdown>(desk));
        (*blocks.back())(true);
        CHECK(blocks.back()->busy() == (i < 32));
    }
    CHECK(blocks.back()->error_id() == 0x041D);
    CHECK(status() == "Running");
    serve();
    const Texts records = log.take();
    CHECK(records.size() == 32); // 31 that came second, and one too many
    CHECK(records.back() == "InstructionFailed 1053 OPCUA_Shutdown");
    life.stopped();
    serve();
    std::size_t done = 0;
    for (const auto& each : blocks) {
        (*each)(true);
        done += each->done() ? 1U : 0U;
        CHECK_FALSE(each->busy());
    }
    CHECK(done == 1);
    // All places are free again.
    OpcuaShutdown another{desk};
    another(true);
    CHECK(another.busy());
}

TEST_CASE_METHOD(ShutdownFixture, "An instance that goes away gives up its place (A-2-6)")
{
    start();
    for (int i = 0; i < 100; ++i) {
        OpcuaShutdown gone{desk};
        gone(true);
        CHECK(gone.busy());
    }
    serve();
    CHECK(status() == "Running");
    {
        OpcuaShutdown gone{desk};
        gone(true);
        serve();
    }
    CHECK(status() == "Shutdown");
}

TEST_CASE_METHOD(ShutdownFixture, "OPCUA_Shutdown ends if a reset comes between (7-3-3)")
{
    start();
    block(true);
    serve();
    life.reset();
    life.stopped();
    serve();
    block(true);
    CHECK(outputs(block) == "done");
    CHECK(status() == "Initializing");
}

TEST_CASE_METHOD(ShutdownFixture, "A simulated PLC executes OPCUA_Shutdown for a variable (A-2-1)")
{
    PlcConfig config;
    config.variables.resize(2);
    config.variables[0].name = "Trigger";
    config.variables[0].type = BuiltInType::Boolean;
    config.variables[1].name = "Outcome";
    config.variables[1].type = BuiltInType::UInt16;
    config.programs.resize(1);
    config.programs[0].kind = PlcProgramKind::Shutdown;
    config.programs[0].target = "Trigger";
    config.programs[0].sets = "Outcome";
    const auto plc = std::move(Plc::create(config).value());
    const auto scan = [&](bool trigger) {
        REQUIRE(plc->image()->memory().store(0, Variant{trigger}).is_good());
        plc->scan(clock.now(), std::chrono::milliseconds{20});
        return plc->image()->pin().value(1);
    };
    start();
    CHECK(scan(false) == Variant{std::uint16_t{0}});
    CHECK(scan(true) == Variant{std::uint16_t{1}});
    plc->instructions().serve(life, log);
    CHECK(status() == "Shutdown");
    life.stopped();
    plc->instructions().serve(life, log);
    CHECK(scan(true) == Variant{std::uint16_t{2}});
    CHECK(scan(false) == Variant{std::uint16_t{0}});
    CHECK(scan(true) == Variant{std::uint16_t{1}});
    plc->instructions().serve(life, log);
    CHECK(scan(true) == Variant{shut_down_code});
    CHECK(log.take() == Texts{"ServerShutDown", "InstructionFailed 20480 OPCUA_Shutdown"});
    config.programs[0].target = "Outcome";
    CHECK_FALSE(Plc::create(config));
}

TEST_CASE_METHOD(ShutdownFixture, "The sample program shuts the server down (A-2-8)")
{
    start();
    bool last_trigger = false;
    bool is_operating = false;
    bool is_shut_down = false;
    const auto scan = [&](bool trigger) {
        if (trigger && !last_trigger) {
            is_operating = true;
            block(false);
        }
        last_trigger = trigger;
        if (is_operating) {
            block(true);
            is_shut_down = is_shut_down || block.done();
            is_operating = !block.done() && !block.error();
        }
    };
    scan(false);
    scan(true);
    scan(true);
    CHECK_FALSE(is_shut_down);
    serve();
    scan(false);
    CHECK_FALSE(is_shut_down);
    life.stopped();
    serve();
    scan(false);
    CHECK(is_shut_down);
    CHECK_FALSE(is_operating);
    // Triggered again it ends with an error and does not run for ever.
    scan(true);
    CHECK(is_operating);
    serve();
    scan(true);
    CHECK_FALSE(is_operating);
    CHECK(block.error_id() == shut_down_code);
}

} // namespace opcua_shutdown_test
