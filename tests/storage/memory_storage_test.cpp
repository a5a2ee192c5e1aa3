#include <busbar/storage/memory_storage.hpp>

#include "core/unfinished.hpp"

#include "media.hpp"

namespace memory_storage_test {

using namespace busbar;
using namespace busbar::test;
using storage::MemoryStorage;

TEST_CASE("memory storage: is full, protected or away when it is told so")
{
    MemoryStorage files;
    REQUIRE(put(files, "a", "1234"));
    files.set_capacity(10);
    CHECK(files.free_space() == 6U);
    // While a file is replaced, both lie there.
    CHECK(put(files, "a", "1234567").error() == StorageError::Full);
    CHECK(read(files, "a") == "1234");
    CHECK(add(files, "a", "56789ABCDE").error() == StorageError::Full);
    CHECK(read(files, "a") == "123456789A");
    files.set_protected(true);
    CHECK(put(files, "a", "").error() == StorageError::Protected);
    CHECK(files.remove("a").error() == StorageError::Protected);
    CHECK(files.make_folder("b", FileAccess::Owner).error() == StorageError::Protected);
    CHECK(read(files, "a").size() == 10);
    files.set_protected(false);
    files.set_away(true);
    CHECK(read_file(files, "a", 9).error() == StorageError::Away);
    CHECK(files.list("", 9).error() == StorageError::Away);
    CHECK(put(files, "a", "").error() == StorageError::Away);
    files.set_away(false);
    CHECK(put(files, "a", ""));
}

TEST_CASE("memory storage: what a power cut leaves takes room until it is removed")
{
    MemoryStorage files;
    REQUIRE(files.make_folder("a/b", FileAccess::Owner));
    files.set_capacity(20);
    for (const char* name : {"x", "a/x", "a/b/x"}) {
        files.cut_power_after(3);
        CHECK_FALSE(put(files, name, "12345"));
        files.restore_power();
    }
    CHECK(files.names().empty());
    CHECK(files.unfinished() == std::vector<std::string>{"a/b/x", "a/x", "x"});
    CHECK(files.free_space() == 11U);
    files.remove_unfinished("a");
    CHECK(files.unfinished() == std::vector<std::string>{"a/b/x", "x"});
    busbar::detail::remove_unfinished_below(files, "");
    CHECK(files.unfinished().empty());
    CHECK(files.free_space() == 20U);
}

TEST_CASE("memory storage: counts reads and tells who may read")
{
    MemoryStorage files;
    REQUIRE(put(files, "open", "x"));
    REQUIRE(files.replace("closed", bytes_of("x"), FileAccess::Owner));
    CHECK(files.is_open_to_others("open"));
    CHECK_FALSE(files.is_open_to_others("closed"));
    files.open_to_others("closed");
    CHECK(files.close_to_others("closed") == true);
    const std::size_t before = files.reads();
    CHECK(read(files, "open") == "x");
    CHECK(files.reads() == before + 1);
    CHECK(files.names() == std::vector<std::string>{"closed", "open"});
    CHECK(files.place("a/b") == "memory:a/b");
}

TEST_CASE("memory storage: one change fails and the next does not")
{
    MemoryStorage files;
    files.fail_once_after(0, StorageError::Failed);
    CHECK(put(files, "a", "x").error() == StorageError::Failed);
    CHECK(files.names().empty());
    CHECK(put(files, "a", "x"));
}

TEST_CASE("memory storage: a folder changes when a name in it comes or goes")
{
    MemoryStorage files;
    std::int64_t second = 0;
    // Whether the folder changes when `work` is done.
    const auto changes = [&](const char* folder, const auto& work) {
        const DateTime now = DateTime::from_unix_seconds(++second);
        const auto before = files.entry(folder);
        files.set_time(now);
        REQUIRE(work());
        const auto after = files.entry(folder);
        REQUIRE((before && after));
        CHECK((after->modified == now) == !(after->version == before->version));
        return after->modified == now;
    };
    REQUIRE(files.make_folder("a", FileAccess::Owner));
    REQUIRE(files.make_folder("b", FileAccess::Owner));
    CHECK(changes("a", [&] { return put(files, "a/x", "1"); }));
    CHECK(changes("a", [&] { return add(files, "a/y", "1"); }));
    CHECK_FALSE(changes("a", [&] { return add(files, "a/y", "2"); }));
    CHECK_FALSE(changes("a", [&] { return put(files, "b/x", "1"); }));
    CHECK(changes("a", [&] { return files.move("a/x", "b/x", WhenThere::Replace); }));
    CHECK(changes("b", [&] { return files.move("a/y", "b/y", WhenThere::Refuse); }));
    CHECK(changes("b", [&] { return files.remove("b/x"); }));
    CHECK(changes("b", [&] { return files.make_folder("b/c", FileAccess::Owner); }));
}

} // namespace memory_storage_test
