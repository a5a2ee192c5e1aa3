#include <catch2/catch.hpp>

#include <busbar/controller/execution_log.hpp>
#include <busbar/controller/execution_log_reader.hpp>
#include <busbar/controller/machine_event_log.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "log_fixture.hpp"

namespace both_logs_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

class QuietClock final : public WallClock {
public:
    DateTime now() const override { return example_start; }
};

/// The way of a record: through the execution log to the event log behind it.
struct BothLogs {
    [[nodiscard]] std::vector<std::string> codes() const
    {
        std::vector<std::string> result;
        for (const MachineEvent& each : events->events()) {
            result.push_back(code_text(*each.type));
        }
        return result;
    }

    QuietClock clock;
    NullLog lines;
    storage::MemoryStorage card;
    storage::MemoryStorage memory;
    std::unique_ptr<MachineEventLog> events{MachineEventLog::create(memory, clock, lines).value()};
    std::unique_ptr<ExecutionLog> log{ExecutionLog::create(card, clock, *events).value()};
};

using Codes = std::vector<std::string>;

} // namespace

TEST_CASE_METHOD(BothLogs, "One record stands in both logs (9-3)")
{
    tell(*log, refused_client().record());
    tell(*log, Happening{RecordKind::AttributeWritten}.record());
    REQUIRE(log->write_pending());
    const auto contents = read_execution_log(card, ExecutionLogOptions{}.folder, {}, 10);
    REQUIRE(contents);
    REQUIRE(contents->entries.size() == 1);
    CHECK(contents->entries[0].details == "ERROR\tBadCertificateUntrusted");
    CHECK(codes() == Codes{"85600000"});
    CHECK_FALSE(log->wants(RecordKind::AttributeWritten));
    CHECK(log->wants(RecordKind::SecurityCleared)); // by the event log only
}

TEST_CASE_METHOD(BothLogs, "An execution log that is not saved is an event while it is so (7-2-2)")
{
    card.set_away(true);
    tell(*log, Happening{RecordKind::ServerStarted}.record());
    CHECK_FALSE(log->write_pending());
    CHECK_FALSE(log->write_pending());
    CHECK(codes() == Codes{"95D00000", "15000000"});
    CHECK(events->plc_error() == PlcError{EventLevel::MinorFault, 0x15000000});
    card.set_away(false);
    REQUIRE(log->write_pending());
    CHECK_FALSE(events->plc_error());
    CHECK(codes().size() == 2);
}

} // namespace both_logs_test
