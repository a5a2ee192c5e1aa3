#include <catch2/catch.hpp>

#include <array>
#include <atomic>
#include <thread>

#include <busbar/controller/opcua_shutdown.hpp>

#include "life_fixture.hpp"

namespace opcua_shutdown_threads_test {

using namespace busbar;
using namespace busbar::controller;
using busbar::test::LifeFixture;

TEST_CASE_METHOD(LifeFixture, "Tasks and the server's thread meet without waiting (A-2-1)")
{
    constexpr std::size_t tasks = 4;
    start();
    InstructionDesk desk;
    std::array<std::uint16_t, tasks> error_ids{};
    std::atomic<std::size_t> ended{0};
    std::array<std::thread, tasks> threads;
    for (std::size_t i = 0; i < tasks; ++i) {
        threads[i] = std::thread{[&, i] {
            OpcuaShutdown block{desk};
            while (!block.done() && !block.error()) {
                block(true);
            }
            error_ids[i] = block.error_id();
            ++ended;
        }};
    }
    while (ended != tasks) {
        desk.serve(life, log);
        if (life.operating_status() == OperatingStatus::Shutdown && !life.has_stopped()) {
            life.stopped();
        }
        std::this_thread::yield();
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
    std::size_t done = 0;
    for (const std::uint16_t error_id : error_ids) {
        CHECK((error_id == 0 || error_id == 0x5000));
        done += error_id == 0 ? 1U : 0U;
    }
    CHECK(done == 1);
}

} // namespace opcua_shutdown_threads_test
