#include <catch2/catch.hpp>

#include "execution_log_world.hpp"
#include "support/effort.hpp"

namespace execution_log_medium_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

TEST_CASE("Whatever the power cuts, lines are whole and what was saved stays (7-1-5)",
          "[power_cut][logs]")
{
    bool is_through = false;
    const Turns cuts{"log cut", 3};
    for (std::size_t steps = cuts.first; !is_through; steps += cuts.stride) {
        LogWorld world;
        world.happen(0, 98);
        REQUIRE(world.log->flush());
        world.medium.cut_power_after(steps);
        world.happen(98, 4); // over a file's end
        is_through = world.log->write_pending().has_value();
        const int saved = 102 - static_cast<int>(world.log->waiting());
        world.medium.restore_power();

        world.restart();
        world.happen("after");
        REQUIRE(world.log->write_pending());
        const auto lines = world.all_lines();
        INFO("power cut after " << steps << " steps, " << saved << " saved");
        REQUIRE(lines.size() > static_cast<std::size_t>(saved));
        auto expected = expected_lines(static_cast<int>(lines.size()) - 1);
        expected.push_back(std::to_string(lines.size() - 1) + " after");
        REQUIRE(lines == expected);
    }
}

TEST_CASE("Whatever fails on the medium, each record is saved once (7-1-1)", "[power_cut][logs]")
{
    for (const StorageError error :
         {StorageError::Away, StorageError::Full, StorageError::Protected, StorageError::Failed}) {
        bool is_through = false;
        const Turns faults{text(error), 5};
        for (std::size_t steps = faults.first; !is_through; steps += faults.stride) {
            LogWorld world;
            world.happen(0, 98);
            REQUIRE(world.log->write_pending());
            world.medium.fail_once_after(steps, error);
            world.happen(98, 4);
            is_through = world.log->write_pending().has_value();
            world.medium.restore_power();
            REQUIRE(world.log->write_pending());
            INFO(text(error) << " after " << steps << " steps");
            REQUIRE(world.all_lines() == expected_lines(102));
            REQUIRE(world.ear.told.size() == (is_through ? 0 : 2));
            REQUIRE(world.log->lost() == 0);
        }
    }
}

TEST_CASE("Whatever fails again while it is mended, each record is saved once (7-1-1)",
          "[power_cut][logs]")
{
    bool is_through = false;
    for (std::size_t steps = 0; !is_through; steps += 7) {
        LogWorld world;
        world.happen(0, 98);
        REQUIRE(world.log->write_pending());
        world.medium.fail_once_after(steps, StorageError::Failed);
        world.happen(98, 4);
        is_through = world.log->write_pending().has_value();
        world.medium.restore_power();
        world.medium.set_protected(true);
        for (int i = 0; i < 3; ++i) {
            static_cast<void>(world.log->write_pending());
        }
        world.medium.set_protected(false);
        REQUIRE(world.log->write_pending());
        INFO("fails after " << steps << " steps");
        REQUIRE(world.all_lines() == expected_lines(102));
        REQUIRE(world.log->lost() == 0);
    }
}

TEST_CASE_METHOD(LogWorld,
                 "A line that was cut is cut off, or ended where there is no room (7-1-5)")
{
    set_file(log_file, line_of(0) + "1\t2017-10-17\t14:5");
    SECTION("cut off")
    {
        happen("v1");
        REQUIRE(log->write_pending());
        CHECK(all_lines() == std::vector<std::string>{"0 v", "1 v1"});
    }
    SECTION("ended")
    {
        happen("v1");
        medium.fail_once_after(0, StorageError::Full);
        REQUIRE(log->write_pending());
        CHECK(all_lines() == std::vector<std::string>{"0 v", "?", "1 v1"});
        CHECK(ear.told.empty());
    }
}

TEST_CASE("Why records are not saved is told once, and that they are again (9-2-2, 15000000)",
          "[power_cut][logs]")
{
    LogWorld world;
    const auto fail_by = [&](auto set, std::uint16_t code) {
        world.ear.told.clear();
        set(true);
        world.happen("v");
        CHECK_FALSE(world.log->write_pending());
        CHECK_FALSE(world.log->write_pending());
        CHECK(world.ear.told == std::vector<std::uint16_t>{code});
        CHECK(world.log->waiting() == 1);
        set(false);
        CHECK(world.log->write_pending());
        CHECK(world.ear.told == std::vector<std::uint16_t>{code, 0});
        CHECK(world.log->waiting() == 0);
        CHECK(world.log->write_pending());
        CHECK(world.ear.told.size() == 2);
    };
    auto& medium = world.medium;
    fail_by([&](bool is_on) { medium.set_away(is_on); }, 0x0001);
    fail_by([&](bool is_on) { medium.set_protected(is_on); }, 0x0003);
    fail_by([&](bool is_on) { medium.set_capacity(is_on ? 10 : UINT64_MAX); }, 0x0005);
    fail_by(
        [&](bool is_on) { world.log->medium_changed(is_on ? LogMedium::Unusable : LogMedium::In); },
        0x0002);
    world.ear.told.clear();
    medium.fail_once_after(0, StorageError::Failed);
    world.happen("v");
    CHECK_FALSE(world.log->write_pending());
    CHECK(world.ear.told == std::vector<std::uint16_t>{0x0302});
}

TEST_CASE_METHOD(LogWorld, "Without a medium at the start records begin when there is one (7-4-1)")
{
    medium.set_away(true);
    happen(0, 2);
    CHECK_FALSE(log->write_pending());
    CHECK(ear.told == std::vector<std::uint16_t>{0x0001});
    medium.set_away(false);
    log->medium_changed(LogMedium::In);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == expected_lines(2));
    CHECK(ear.told == std::vector<std::uint16_t>{0x0001, 0});
}

TEST_CASE_METHOD(LogWorld, "While the medium is changed records wait and nothing is told (7-4-3)")
{
    happen(0, 2);
    REQUIRE(log->release_medium());
    CHECK(all_lines() == expected_lines(2));
    const std::size_t steps = medium.steps();
    happen(2, 600); // 30 seconds at one in 50 ms (7-4-4)
    CHECK_FALSE(log->write_pending());
    CHECK(medium.steps() == steps);
    CHECK(ear.told.empty());
    // Another medium, with a log of its own: numbers go on.
    set_file(log_file, line_of(7));
    log->medium_changed(LogMedium::In);
    REQUIRE(log->write_pending());
    CHECK(ear.told.empty());
    const auto lines = all_lines();
    CHECK(lines.size() == 601);
    CHECK(lines[0] == "7 v");
    CHECK(lines[1] == "2 v2");
    CHECK(lines.back() == "601 v601");
}

TEST_CASE("What there is no room for is lost and told (7-4-5)")
{
    LogWorld world{{.max_records = 100, .max_waiting = 600}};
    world.log->medium_changed(LogMedium::Out);
    world.happen(0, 600);
    CHECK_FALSE(world.log->write_pending());
    CHECK(world.ear.told.empty());
    world.happen(600, 3);
    CHECK(world.log->lost() == 3);
    CHECK(world.ear.told.empty()); // not by the server's thread
    CHECK_FALSE(world.log->write_pending());
    CHECK(world.ear.told == std::vector<std::uint16_t>{0x0001});
    world.log->medium_changed(LogMedium::In);
    REQUIRE(world.log->write_pending());
    CHECK(world.ear.told == std::vector<std::uint16_t>{0x0001, 0});
    CHECK(world.all_lines() == expected_lines(600));
}

TEST_CASE("One whole Preparing waits by default (7-4-5)")
{
    LogWorld world{{}};
    world.log->medium_changed(LogMedium::Out);
    world.log->record(Happening{RecordKind::ServerPreparing}.record());
    world.happen(0, 10'000);
    world.log->record(Happening{RecordKind::VariablesCounted}.record());
    world.log->record(Happening{RecordKind::ServerRunning}.record());
    world.happen(10'000, 600);
    CHECK(world.log->lost() == 0);
    CHECK(world.log->waiting() == 10'603);
}

TEST_CASE_METHOD(LogWorld, "What still waits when the power goes is told as lost (7-1-1)")
{
    log->medium_changed(LogMedium::Out);
    CHECK_FALSE(log->flush());
    CHECK(ear.told.empty());
    happen("v0");
    CHECK_FALSE(log->flush());
    CHECK(ear.told == std::vector<std::uint16_t>{0x0001});
}

TEST_CASE_METHOD(LogWorld, "The expiration of a certificate is noticed only once (7-1-1)")
{
    const auto notice = [&](RecordKind kind, const crypto::Certificate& certificate) {
        Happening happening{kind};
        happening.of(certificate.der());
        log->record(happening.record());
        return log->waiting();
    };
    const auto other = certificate_of("other", example_start, 10);
    CHECK(notice(RecordKind::CertificateExpiring, sample_client()) == 1);
    CHECK(notice(RecordKind::CertificateExpiring, sample_client()) == 1);
    CHECK(notice(RecordKind::CertificateExpired, sample_client()) == 2);
    CHECK(notice(RecordKind::CertificateExpiring, other) == 3);
    CHECK(notice(RecordKind::CertificateUpdated, other) == 4);
    CHECK(notice(RecordKind::CertificateExpiring, other) == 5);
    restart();
    CHECK(notice(RecordKind::CertificateExpiring, other) == 1);
}

TEST_CASE_METHOD(LogWorld, "The log is cleared and goes on (7-2-2)")
{
    happen(0, 250);
    REQUIRE(log->write_pending());
    CHECK(log_files().size() == 3);
    REQUIRE(log->clear());
    CHECK(log_files().empty());
    happen(250, 1);
    REQUIRE(log->write_pending());
    CHECK(all_lines() == std::vector<std::string>{"250 v250"});
    medium.set_away(true);
    CHECK_FALSE(log->clear());
}

} // namespace execution_log_medium_test
