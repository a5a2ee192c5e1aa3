#include <catch2/catch.hpp>

#include <functional>
#include <map>
#include <string>

#include "controller/life/logged_life.hpp"

namespace event_log_power_cut_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

using SetFault = std::function<void(storage::MemoryStorage&, bool)>;

const std::map<std::string, SetFault> event_storage_faults{
    {"full", [](auto& storage, bool is_on) { storage.set_capacity(is_on ? 0 : UINT64_MAX); }},
    {"protected", [](auto& storage, bool is_on) { storage.set_protected(is_on); }},
    {"away", [](auto& storage, bool is_on) { storage.set_away(is_on); }},
};

void refuse_clients(MachineEventLog& log, int from, int count)
{
    for (int i = from; i < from + count; ++i) {
        log.record(Happening{RecordKind::LoginRefused}
                       .by("user" + std::to_string(i))
                       .with(status::Bad_UserAccessDenied)
                       .record());
    }
}

} // namespace

TEST_CASE("Events wait for a storage that is full, protected or away (9-2-2)", "[power_cut][logs]")
{
    for (const auto& [name, set] : event_storage_faults) {
        for (const bool is_at_start : {true, false}) {
            INFO(name << (is_at_start ? " at the start" : " later"));
            LoggedLife machine;
            const int before = is_at_start ? 0 : 3;
            refuse_clients(*machine.event_log, 0, before);
            REQUIRE((is_at_start || machine.event_log->write_pending()));
            set(machine.memory, true);
            refuse_clients(*machine.event_log, before, 4);
            CHECK_FALSE(machine.event_log->write_pending());
            CHECK_FALSE(machine.event_log->write_pending());
            CHECK(machine.events().size() == static_cast<std::size_t>(before + 4));
            set(machine.memory, false);
            REQUIRE(machine.event_log->write_pending());

            const auto next =
                MachineEventLog::create(machine.memory, machine.clock, machine.lines).value();
            REQUIRE(next->load());
            refuse_clients(*next, before + 4, 1);
            const auto events = next->events();
            REQUIRE(events.size() == static_cast<std::size_t>(before + 5));
            for (std::size_t i = 0; i < events.size(); ++i) {
                CHECK(events[i].number == i + 1);
                CHECK(events[i].attached.at(1) == "user" + std::to_string(i));
            }
        }
    }
}

} // namespace event_log_power_cut_test
