#include <busbar/storage/memory_storage.hpp>

#include "media.hpp"

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
