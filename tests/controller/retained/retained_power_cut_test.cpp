#include <catch2/catch.hpp>

#include "retained_fixture.hpp"

namespace retained_power_cut_test {

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

TEST_CASE("Retained values survive a power cut at every byte (6-2-2)", "[power_cut][retained]")
{
    bool has_ended = false;
    for (std::size_t steps = 0; !has_ended; ++steps) {
        storage::MemoryStorage storage;
        RetainingController plc{storage};
        plc.work(1);
        REQUIRE(plc.retained->save());
        storage.cut_power_after(steps);
        std::int32_t acknowledged = 1;
        for (std::int32_t number = 2; number <= 3; ++number) {
            plc.work(number);
            acknowledged = plc.retained->save() ? number : acknowledged;
        }
        has_ended = acknowledged == 3;
        storage.restore_power();
        RetainingController next{storage};
        INFO("after " << steps << " steps");
        CHECK(next.restored.problems.empty());
        CHECK(next.restored.restored == 3);
        REQUIRE(next.number());
        CHECK(*next.number() >= acknowledged);
        next.work(9);
        CHECK(next.retained->save());
        CHECK(RetainingController{storage}.number() == 9);
    }
}

TEST_CASE("A damaged file is kept through a power cut at every byte (6-2-2)",
          "[power_cut][retained]")
{
    bool has_ended = false;
    for (std::size_t steps = 0; !has_ended; ++steps) {
        storage::MemoryStorage storage;
        const std::vector<std::byte> bad(30, std::byte{7});
        REQUIRE(storage.replace("retained", bad, FileAccess::Owner));
        RetainingController plc{storage};
        plc.work(1);
        storage.cut_power_after(steps);
        has_ended = plc.retained->save().has_value();
        storage.restore_power();
        const bool is_in_place = read_file(storage, "retained", 1000) == bad;
        const bool is_kept = read_file(storage, "retained.kept", 1000) == bad;
        CHECK((is_in_place || is_kept));
        RetainingController next{storage};
        CHECK(next.number() == (has_ended ? 1 : 0));
    }
}

TEST_CASE("A medium that is full, protected or away loses nothing (6-2-2)", "[power_cut][retained]")
{
    storage::MemoryStorage storage;
    RetainingController plc{storage};
    plc.work(1);
    REQUIRE(plc.retained->save());
    plc.work(2);
    SECTION("full")
    {
        storage.set_capacity(0);
        CHECK(plc.retained->save().error() == StorageError::Full);
        storage.set_capacity(UINT64_MAX);
    }
    SECTION("protected")
    {
        storage.set_protected(true);
        CHECK(plc.retained->save().error() == StorageError::Protected);
        storage.set_protected(false);
    }
    SECTION("away")
    {
        storage.set_away(true);
        CHECK(plc.retained->save().error() == StorageError::Away);
        storage.set_away(false);
    }
    SECTION("failing once")
    {
        storage.fail_once_after(3, StorageError::Failed);
        CHECK(plc.retained->save().error() == StorageError::Failed);
    }
    CHECK(RetainingController{storage}.number() == 1);
    CHECK(plc.retained->save());
    CHECK(RetainingController{storage}.number() == 2);
}

TEST_CASE("A medium that is away at the start is no reason not to start (6-2-2)",
          "[power_cut][retained]")
{
    storage::MemoryStorage storage;
    RetainingController first{storage};
    first.work(1);
    REQUIRE(first.retained->save());
    storage.set_away(true);
    RetainingController second{storage};
    REQUIRE(second.restored.problems.size() == 1);
    CHECK(second.number() == 0);
    second.work(5);
    CHECK_FALSE(second.retained->save());
    storage.set_away(false);
    CHECK(second.retained->save());
    CHECK(storage.names() == std::vector<std::string>{"retained", "retained.kept"});
    CHECK(RetainingController{storage}.number() == 5);
}

} // namespace retained_power_cut_test
