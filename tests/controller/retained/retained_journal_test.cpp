#include <catch2/catch.hpp>

#include <algorithm>
#include <cstring>

#include "retained_fixture.hpp"

namespace retained_journal_test {

// What clients write into RETAIN variables outlasts the end of the program, at any byte.

using namespace busbar;
using namespace busbar::controller;
using namespace busbar::test;

namespace {

constexpr const char* first_file = "retained.journal-1";
constexpr const char* second_file = "retained.journal-2";

/// A Write of a client, which the task applies and publishes.
Stored<void> write(RetainingController& plc, std::int32_t number)
{
    plc.work(number);
    std::vector<std::byte> text(sizeof(std::uint32_t));
    const std::string recipe = "recipe " + std::to_string(number);
    const auto size = static_cast<std::uint32_t>(recipe.size());
    std::memcpy(text.data(), &size, sizeof size);
    const auto bytes = std::as_bytes(std::span{recipe});
    text.insert(text.end(), bytes.begin(), bytes.end());
    const server::ImagePlace& axes = plc.made->image()->place(2);
    const std::byte* const second = plc.memory().bytes(axes) + axes.stride;
    const std::vector<server::ImageWrite> writes{{0, 0, std::as_bytes(std::span{&number, 1})},
                                                 {1, 0, text},
                                                 {2, axes.stride, {second, axes.stride}}};
    return plc.retained->keep(writes);
}

std::vector<std::byte> bytes_of(storage::MemoryStorage& storage, const char* name)
{
    return read_file(storage, name, 1'000'000).value_or(std::vector<std::byte>{});
}

bool is_there(storage::MemoryStorage& storage, const char* name)
{
    return storage.entry(name).has_value();
}

} // namespace

TEST_CASE("retained journal: a Write outlasts the program without a save", "[retained]")
{
    storage::MemoryStorage storage;
    {
        RetainingController plc{storage};
        CHECK(plc.retained->keeps(0));
        CHECK(plc.retained->keeps(2));
        CHECK_FALSE(plc.retained->keeps(3)); // not RETAIN
        CHECK_FALSE(plc.retained->keeps(9)); // not there
        plc.work(1);
        REQUIRE(plc.retained->save());
        REQUIRE(write(plc, 2));
        REQUIRE(write(plc, 3));
    }
    RetainingController next{storage};
    CHECK(next.restored.problems.empty());
    CHECK(next.restored.restored == 3);
    CHECK(next.number() == 3);
    CHECK_FALSE(is_there(storage, first_file)); // the file has it
    CHECK(RetainingController{storage}.number() == 3);
}

TEST_CASE("retained journal: what was never saved begins with the declared values", "[retained]")
{
    storage::MemoryStorage storage;
    {
        RetainingController plc{storage};
        plc.memory().structure(2, 0).value<bool>(0) = true; // by the program
        REQUIRE(write(plc, 2));
    }
    RetainingController next{storage};
    CHECK(next.restored.restored == 3);
    CHECK(next.number() == 2);
    CHECK_FALSE(next.memory().structure(2, 0).value<bool>(0));
}

TEST_CASE("retained journal: a save takes what was written before it", "[retained]")
{
    storage::MemoryStorage storage;
    RetainingController plc{storage};
    REQUIRE(write(plc, 1));
    CHECK(is_there(storage, first_file));
    REQUIRE(plc.retained->save());
    CHECK_FALSE(is_there(storage, first_file));
    REQUIRE(write(plc, 2));
    CHECK(is_there(storage, second_file));
    // The program has changed it since; the file is newer than the journal's Writes before it.
    plc.work(5);
    REQUIRE(plc.retained->save());
    CHECK(storage.names() == std::vector<std::string>{"retained"});
    CHECK(RetainingController{storage}.number() == 5);
}

TEST_CASE("retained journal: values that are as they were are saved with the Writes' number",
          "[retained]")
{
    storage::MemoryStorage storage;
    RetainingController plc{storage};
    REQUIRE(write(plc, 1));
    REQUIRE(plc.retained->save());
    REQUIRE(write(plc, 2));
    REQUIRE(write(plc, 1));
    REQUIRE(plc.retained->save());
    CHECK(storage.names() == std::vector<std::string>{"retained"});
    CHECK(RetainingController{storage}.number() == 1);
}

TEST_CASE("retained journal: no value is older than the last acknowledged Write, at any byte",
          "[power_cut][retained]")
{
    bool has_ended = false;
    for (std::size_t steps = 0; !has_ended; ++steps) {
        storage::MemoryStorage storage;
        RetainingController plc{storage};
        plc.work(1);
        REQUIRE(plc.retained->save());
        storage.cut_power_after(steps);
        std::int32_t acknowledged = 1;
        const auto acknowledge = [&](std::int32_t number, const Stored<void>& done) {
            acknowledged = done ? number : acknowledged;
        };
        acknowledge(2, write(plc, 2));
        acknowledge(3, write(plc, 3));
        const bool is_saved = plc.retained->save().has_value();
        acknowledge(4, write(plc, 4));
        static_cast<void>(plc.retained->sync());
        acknowledge(5, write(plc, 5));
        has_ended = is_saved && acknowledged == 5;
        storage.restore_power();
        INFO("after " << steps << " steps");
        RetainingController next{storage};
        REQUIRE(next.number());
        CHECK(*next.number() >= acknowledged);
        CHECK(next.restored.restored == 3);
        for (const Problem& problem : next.restored.problems) {
            CHECK(problem.text.find("was cut off") != std::string::npos);
        }
        REQUIRE(write(next, 9));
        CHECK(RetainingController{storage}.number() == 9);
    }
}

TEST_CASE("retained journal: the restore itself may be cut at any byte", "[power_cut][retained]")
{
    bool has_ended = false;
    for (std::size_t steps = 0; !has_ended; ++steps) {
        storage::MemoryStorage storage;
        {
            RetainingController plc{storage};
            plc.work(1);
            REQUIRE(plc.retained->save());
            REQUIRE(write(plc, 2));
        }
        storage.cut_power_after(steps);
        RetainingController cut{storage};
        cut.scan();
        has_ended = cut.retained->save().has_value();
        storage.restore_power();
        INFO("after " << steps << " steps");
        CHECK(RetainingController{storage}.number() == 2);
    }
}

TEST_CASE("retained journal: a power cut takes what was not synced, and no more",
          "[power_cut][retained]")
{
    for (std::size_t kept = 0; kept < 400; ++kept) {
        storage::MemoryStorage storage;
        {
            RetainingController plc{storage};
            REQUIRE(write(plc, 1));
            REQUIRE(plc.retained->sync());
            REQUIRE(write(plc, 2));
            REQUIRE(write(plc, 3));
        }
        storage.lose_unsynced(kept);
        RetainingController next{storage};
        REQUIRE(next.number());
        CHECK(*next.number() >= 1);
    }
}

TEST_CASE("retained journal: damage is told, kept and passed over; the start goes on", "[retained]")
{
    storage::MemoryStorage storage;
    {
        RetainingController plc{storage};
        REQUIRE(write(plc, 1));
        REQUIRE(write(plc, 2));
        REQUIRE(write(plc, 3));
    }
    const auto good = bytes_of(storage, first_file);
    for (std::size_t i = 0; i < good.size(); ++i) {
        auto bad = good;
        bad[i] ^= std::byte{0x40};
        storage::MemoryStorage damaged;
        REQUIRE(damaged.replace(first_file, bad, FileAccess::Owner));
        RetainingController next{damaged};
        INFO("byte " << i);
        REQUIRE_FALSE(next.restored.problems.empty());
        CHECK(next.restored.problems.size() <= 2);
        CHECK(next.restored.problems[0].where == first_file);
        REQUIRE(next.number());
        const bool is_cut = next.restored.problems.back().text.find("cut off") != std::string::npos;
        CHECK((is_cut || bytes_of(damaged, "retained.journal-1.kept") == bad));
        REQUIRE(write(next, 7));
        CHECK(RetainingController{damaged}.number() == 7);
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        storage::MemoryStorage cut;
        REQUIRE(cut.replace(first_file, std::span{good}.first(size), FileAccess::Owner));
        RetainingController next{cut};
        CHECK(next.number());
        CHECK(next.restored.problems.size() <= 1);
    }
}

TEST_CASE("retained journal: Writes are refused from a failure to the next save", "[retained]")
{
    storage::MemoryStorage storage;
    RetainingController plc{storage};
    REQUIRE(write(plc, 1));
    REQUIRE(plc.retained->handle_deadline(TimePoint{} + std::chrono::hours{1}));
    CHECK(plc.retained->next_deadline() > TimePoint{});
    storage.fail_once_after(10, StorageError::Full);
    CHECK(write(plc, 2).error() == StorageError::Full);
    CHECK(plc.retained->next_deadline() == TimePoint::min());
    CHECK(write(plc, 3).error() == StorageError::Full); // not after a record that is cut off
    REQUIRE(plc.retained->save());
    REQUIRE(write(plc, 4));
    CHECK(RetainingController{storage}.restored.problems.empty());
    CHECK(RetainingController{storage}.number() == 4);
}

TEST_CASE("retained journal: it grows to a bound", "[retained]")
{
    storage::MemoryStorage storage;
    Program program = retaining_program();
    program.variables.push_back(
        {.name = "Table",
         .type = {.elementary = ElementaryType::Dint, .dimensions = {{0, 249'999}}},
         .is_retained = true});
    RetainingController plc{storage, program};
    plc.work(1);
    REQUIRE(plc.retained->handle_deadline(TimePoint{}));
    const std::vector<std::byte> table(1'000'000);
    const std::vector<server::ImageWrite> writes{{4, 0, table}};
    std::size_t count = 0;
    while (plc.retained->keep(writes)) {
        ++count;
        CHECK((plc.retained->next_deadline() == TimePoint::min()) == (count > 4));
        REQUIRE(count < 100);
    }
    CHECK(count == 33);
    REQUIRE(plc.retained->save());
    CHECK(plc.retained->keep(writes));
}

TEST_CASE("retained journal: a part of an array is put into what the file has", "[retained]")
{
    storage::MemoryStorage storage;
    Program program = retaining_program();
    program.variables.push_back(
        {.name = "Table",
         .type = {.elementary = ElementaryType::Dint, .dimensions = {{0, 3}}},
         .is_retained = true});
    {
        RetainingController plc{storage, program};
        std::ranges::copy(std::vector<std::int32_t>{1, 2, 3, 4},
                          plc.memory().values<std::int32_t>(4).begin());
        plc.scan();
        REQUIRE(plc.retained->save());
        const std::int32_t nine = 9;
        const std::vector<server::ImageWrite> writes{
            {4, 2 * sizeof nine, std::as_bytes(std::span{&nine, 1})}};
        REQUIRE(plc.retained->keep(writes));
    }
    SECTION("of the same type")
    {
        RetainingController next{storage, program};
        CHECK(std::ranges::equal(next.memory().values<std::int32_t>(4),
                                 std::vector<std::int32_t>{1, 2, 9, 4}));
    }
    SECTION("of another type")
    {
        program.variables[4].type.elementary = ElementaryType::Udint;
        RetainingController next{storage, program};
        REQUIRE(next.restored.problems.size() == 1);
        CHECK(next.restored.problems[0].where == "retained: Table");
        CHECK(next.restored.restored == 3);
    }
    SECTION("of a variable that is gone")
    {
        program.variables.pop_back();
        RetainingController next{storage, program};
        CHECK(next.restored.problems.empty());
    }
}

} // namespace retained_journal_test
