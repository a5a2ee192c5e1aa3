#pragma once

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <vector>

#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/execution_log_reader.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "controller/life/life_fixture.hpp"
#include "controller/logs/log_fixture.hpp"

namespace busbar::test {

/// What a log says, without number and time: "SERVER 0110 NumOfVariables Variables=1, ...".
inline Texts lines_of(const controller::ExecutionLogContents& contents)
{
    CHECK(contents.damaged == 0);
    Texts lines;
    for (const controller::ExecutionLogEntry& entry : contents.entries) {
        const auto columns = controller::execution_log_columns(entry);
        std::string line = columns[2] + " " + columns[3] + " " + columns[4];
        line += columns[5].empty() ? "" : " " + columns[5];
        lines.push_back(std::move(line));
    }
    return lines;
}

/// A controller whose server's life comes into both logs. The test is its server.
struct LoggedLife {
    LoggedLife() { clock.time = example_start; }

    [[nodiscard]] static controller::ServerSettings used() { return LifeFixture::used(); }
    void start(const controller::ServerSettings& settings = used())
    {
        life.power_on();
        life.initialized(settings);
        finish_preparation();
    }
    void finish_preparation() { life.prepared(server.number, life_url); }
    [[nodiscard]] std::string status() const
    {
        return std::string{controller::text(life.operating_status())};
    }
    /// All that the execution log on the card says.
    [[nodiscard]] Texts logged()
    {
        REQUIRE(log->write_pending());
        const auto contents = controller::read_execution_log(
            card, controller::ExecutionLogOptions{}.folder, {}, 1'000);
        REQUIRE(contents);
        return lines_of(*contents);
    }
    /// "95D00000", the oldest first.
    [[nodiscard]] Texts events() const
    {
        Texts codes;
        for (const controller::MachineEvent& each : event_log->events()) {
            codes.push_back(code_text(*each.type));
        }
        return codes;
    }

    SetClock clock;
    NullLog lines;
    storage::MemoryStorage card;
    storage::MemoryStorage memory;
    std::unique_ptr<controller::MachineEventLog> event_log{
        controller::MachineEventLog::create(memory, clock, lines).value()};
    std::unique_ptr<controller::ExecutionLog> log{
        controller::ExecutionLog::create(card, clock, *event_log).value()};
    ServerStub server;
    controller::LifeCycle life{server, clock, *log};
};

} // namespace busbar::test
