#include <busbar/core/storage.hpp>

#include "media.hpp"

namespace contract_test {

// What every Storage does, whatever is below it.

using namespace busbar;
using namespace busbar::test;

namespace {

template <typename Check>
void on_each(Check check)
{
    for (const auto& medium : {on_disk(), in_memory()}) {
        INFO(medium->name);
        REQUIRE(medium->storage->make_folder("", FileAccess::Everyone));
        check(*medium->storage);
    }
}

StorageError error_of(const Stored<void>& result)
{
    REQUIRE_FALSE(result);
    return result.error();
}

} // namespace

TEST_CASE("storage: a file is replaced, read in parts and removed")
{
    on_each([](Storage& storage) {
        CHECK(storage.entry("a").error() == StorageError::NotFound);
        CHECK(storage.read("a", 0, {}).error() == StorageError::NotFound);
        CHECK(error_of(storage.remove("a")) == StorageError::NotFound);
        REQUIRE(put(storage, "a", "first"));
        CHECK(read(storage, "a") == "first");
        REQUIRE(put(storage, "a", "another one"));
        CHECK(read(storage, "a") == "another one");
        CHECK(storage.entry("a")->size == 11);
        CHECK(storage.entry("a")->name == "a");
        char part[4]{};
        CHECK(storage.read("a", 8, std::as_writable_bytes(std::span{part})) == 3U);
        CHECK(std::string_view{part} == "one");
        CHECK(storage.read("a", 11, std::as_writable_bytes(std::span{part})) == 0U);
        CHECK(storage.read("a", UINT64_MAX, std::as_writable_bytes(std::span{part})) == 0U);
        REQUIRE(put(storage, "a", ""));
        CHECK(read(storage, "a").empty());
        REQUIRE(storage.remove("a"));
        CHECK(storage.entry("a").error() == StorageError::NotFound);
    });
}

TEST_CASE("storage: what is longer than asked for is not read")
{
    on_each([](Storage& storage) {
        REQUIRE(put(storage, "a", "12345"));
        CHECK(read(storage, "a", 5) == "12345");
        CHECK(read_file(storage, "a", 4).error() == StorageError::TooLarge);
        CHECK(read_file(storage, "a", 0).error() == StorageError::TooLarge);
    });
}

TEST_CASE("storage: bytes are appended")
{
    on_each([](Storage& storage) {
        REQUIRE(add(storage, "log", "one\n"));
        REQUIRE(add(storage, "log", "two\n"));
        REQUIRE(add(storage, "log", ""));
        CHECK(read(storage, "log") == "one\ntwo\n");
        CHECK(error_of(add(storage, "no/log", "x")) == StorageError::NotFound);
        REQUIRE(storage.make_folder("taken", FileAccess::Everyone));
        CHECK_FALSE(add(storage, "taken", "x"));
        CHECK_FALSE(put(storage, "taken", "x"));
        CHECK(names(storage, "") == std::vector<std::string>{"log", "taken/"});
    });
}

TEST_CASE("storage: bytes are appended that a later call brings to the medium")
{
    on_each([](Storage& storage) {
        const auto add_unsynced = [&](std::string_view name, std::string_view text) {
            return storage.append_unsynced(name, bytes_of(text), FileAccess::Owner);
        };
        CHECK(error_of(storage.sync("log")) == StorageError::NotFound);
        REQUIRE(add_unsynced("log", "one\n"));
        REQUIRE(add_unsynced("log", "two\n"));
        CHECK(read(storage, "log") == "one\ntwo\n");
        REQUIRE(storage.sync("log"));
        REQUIRE(add(storage, "log", "three\n"));
        CHECK(read(storage, "log") == "one\ntwo\nthree\n");
        CHECK(error_of(add_unsynced("no/log", "x")) == StorageError::NotFound);
        CHECK(error_of(add_unsynced("..", "x")) == StorageError::BadName);
        CHECK(error_of(storage.sync("..")) == StorageError::BadName);
    });
}

TEST_CASE("storage: memory loses what was not synced, as a power cut has it")
{
    storage::MemoryStorage storage;
    REQUIRE(add(storage, "log", "one"));
    REQUIRE(storage.append_unsynced("log", bytes_of("two"), FileAccess::Owner));
    REQUIRE(storage.sync("log"));
    REQUIRE(storage.append_unsynced("log", bytes_of("three"), FileAccess::Owner));
    storage.lose_unsynced(2);
    CHECK(read(storage, "log") == "onetwoth");
    storage.lose_unsynced(0);
    CHECK(read(storage, "log") == "onetwoth");
}

TEST_CASE("storage: folders are made with those above, listed and removed when empty")
{
    on_each([](Storage& storage) {
        CHECK(error_of(put(storage, "a/b/c", "x")) == StorageError::NotFound);
        REQUIRE(storage.make_folder("a/b", FileAccess::Owner));
        REQUIRE(storage.make_folder("a/b", FileAccess::Owner));
        REQUIRE(storage.make_folder("a", FileAccess::Owner));
        REQUIRE(put(storage, "a/b/c", "x"));
        REQUIRE(put(storage, "a/z", "y"));
        REQUIRE(put(storage, "a.b", "another"));
        CHECK(names(storage, "") == std::vector<std::string>{"a/", "a.b"});
        CHECK(names(storage, "a") == std::vector<std::string>{"b/", "z"});
        CHECK(storage.list("no", 9).error() == StorageError::NotFound);
        CHECK(error_of(storage.remove("a/b")) == StorageError::Exists);
        REQUIRE(storage.remove("a/b/c"));
        REQUIRE(storage.remove("a/b"));
        CHECK(names(storage, "a") == std::vector<std::string>{"z"});
        CHECK_FALSE(storage.make_folder("a/z", FileAccess::Everyone));
        CHECK_FALSE(storage.make_folder("a/z/below", FileAccess::Everyone));
        const auto cut = storage.list("", 1);
        CHECK(cut->entries.size() == 1);
        CHECK(cut->is_cut);
        CHECK_FALSE(storage.list("", 2)->is_cut);
    });
}

TEST_CASE("storage: a file is moved, and replaces another only where that is asked for")
{
    on_each([](Storage& storage) {
        REQUIRE(storage.make_folder("to", FileAccess::Everyone));
        REQUIRE(put(storage, "a", "A"));
        REQUIRE(put(storage, "to/b", "B"));
        CHECK(error_of(storage.move("a", "to/b", WhenThere::Refuse)) == StorageError::Exists);
        CHECK(error_of(storage.move("no", "x", WhenThere::Refuse)) == StorageError::NotFound);
        CHECK(error_of(storage.move("a", "no/x", WhenThere::Refuse)) == StorageError::NotFound);
        CHECK(read(storage, "a") == "A");
        REQUIRE(storage.move("a", "to/c", WhenThere::Refuse));
        CHECK(names(storage, "to") == std::vector<std::string>{"b", "c"});
        REQUIRE(storage.move("to/c", "to/b", WhenThere::Replace));
        CHECK(names(storage, "to") == std::vector<std::string>{"b"});
        CHECK(read(storage, "to/b") == "A");
    });
}

TEST_CASE("storage: another file has another version")
{
    on_each([](Storage& storage) {
        REQUIRE(put(storage, "a", "1"));
        const auto before = storage.entry("a")->version;
        CHECK(storage.entry("a")->version == before);
        REQUIRE(put(storage, "a", "2"));
        CHECK_FALSE(storage.entry("a")->version == before);
    });
}

TEST_CASE("storage: a file is closed to others")
{
    on_each([](Storage& storage) {
        REQUIRE(put(storage, "open", "x"));
        REQUIRE(storage.replace("closed", bytes_of("x"), FileAccess::Owner));
        CHECK(storage.close_to_others("open") == true);
        CHECK(storage.close_to_others("open") == false);
        CHECK(storage.close_to_others("closed") == false);
        CHECK(storage.close_to_others("no").error() == StorageError::NotFound);
        CHECK(read(storage, "open") == "x");
    });
}

TEST_CASE("storage: no name leads out of the root")
{
    on_each([](Storage& storage) {
        using namespace std::string_view_literals;
        for (const std::string_view name : {""sv, "/a"sv, "a/"sv, "a//b"sv, "."sv, ".."sv, "../a"sv,
                                            "a/../b"sv, "a/./b"sv, "a\0b"sv}) {
            INFO(name);
            CHECK_FALSE(is_storage_name(name));
            CHECK(storage.entry(name).error() == StorageError::BadName);
            CHECK(storage.read(name, 0, {}).error() == StorageError::BadName);
            CHECK(error_of(put(storage, name, "x")) == StorageError::BadName);
            CHECK(error_of(add(storage, name, "x")) == StorageError::BadName);
            CHECK(error_of(storage.remove(name)) == StorageError::BadName);
            CHECK(error_of(storage.move(name, "a", WhenThere::Replace)) == StorageError::BadName);
            CHECK(error_of(storage.move("a", name, WhenThere::Replace)) == StorageError::BadName);
            CHECK((name.empty() || storage.list(name, 1).error() == StorageError::BadName));
            CHECK((name.empty() || error_of(storage.make_folder(name, FileAccess::Owner)) ==
                                       StorageError::BadName));
        }
        const std::string longest(255, 'x');
        CHECK(is_storage_name(longest));
        CHECK_FALSE(is_storage_name(longest + "x"));
        CHECK(is_storage_name("..a/b.c/..."));
        CHECK_FALSE(
            is_storage_name(longest + "/" + longest + "/" + longest + "/" + longest + "/a"));
        CHECK(names(storage, "").empty());
    });
}

TEST_CASE("storage: errors have a text and a status")
{
    for (int i = 0; i <= static_cast<int>(StorageError::Failed); ++i) {
        const auto error = static_cast<StorageError>(i);
        CHECK_FALSE(text(error).empty());
        CHECK(status_of(error).is_bad());
    }
}

} // namespace contract_test
