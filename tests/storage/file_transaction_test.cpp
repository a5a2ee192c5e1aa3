#include <busbar/core/file_transaction.hpp>

#include <map>
#include <optional>

#include "media.hpp"
#include "support/failing_disk.hpp"

namespace file_transaction_test {

using namespace busbar;
using namespace busbar::test;
using storage::FolderStorage;
using storage::MemoryStorage;

namespace {

using Files = std::map<std::string, std::string>;

const Files before{{"a", "old"}, {"b", "old too"}, {"to/c", "goes"}, {"to/d", "stays"}};
const Files after{{"a", "new"}, {"b", "new too, and longer"}, {"to/d", "stays"}, {"to/e", "made"}};

void fill(Storage& storage)
{
    REQUIRE(storage.make_folder("to", FileAccess::Everyone));
    for (const auto& [name, text] : before) {
        REQUIRE(put(storage, name, text));
    }
}

Files files_of(Storage& storage)
{
    Files files;
    for (const char* folder : {"", "to"}) {
        const auto listing = storage.list(folder, 100);
        REQUIRE(listing);
        for (const StorageEntry& entry : listing->entries) {
            if (entry.kind == StorageEntry::Kind::File) {
                const std::string name = storage_path(folder, entry.name);
                files[name] = read(storage, name);
            }
        }
    }
    return files;
}

Stored<void> prepare(FileTransaction& change)
{
    for (const auto& [name, text] : after) {
        if (before.find(name) == before.end() || before.at(name) != text) {
            if (auto done = change.replace(name, bytes_of(text), FileAccess::Everyone); !done) {
                return done;
            }
        }
    }
    return change.remove("to/c");
}

/// As a program does it that starts, and finds what the last one left.
bool run(Storage& storage)
{
    FileTransaction change{storage, "transaction"};
    return change.recover() && prepare(change) && change.commit();
}

void restart(Storage& storage)
{
    FileTransaction change{storage, "transaction"};
    REQUIRE(change.recover());
    CHECK_FALSE(change.is_decided());
    const auto left = storage.list("transaction", 10);
    CHECK((!left || left->entries.empty()));
}

} // namespace

TEST_CASE("file transaction: all files change at once")
{
    for (const auto& medium : {on_disk(), in_memory()}) {
        Storage& storage = *medium->storage;
        fill(storage);
        FileTransaction change{storage, "transaction"};
        CHECK(change.empty());
        CHECK(change.commit());
        REQUIRE(prepare(change));
        CHECK_FALSE(change.empty());
        CHECK(files_of(storage) == before);
        REQUIRE(change.commit());
        CHECK(files_of(storage) == after);
        CHECK(change.empty());
        restart(storage);
        CHECK(files_of(storage) == after);
    }
}

TEST_CASE("file transaction: what is not committed leaves nothing behind")
{
    MemoryStorage storage;
    fill(storage);
    {
        FileTransaction change{storage, "transaction"};
        REQUIRE(prepare(change));
        change.cancel();
        CHECK(storage.list("transaction", 10)->entries.empty());
        CHECK(change.commit());
        CHECK(files_of(storage) == before);
        REQUIRE(prepare(change));
    }
    CHECK(storage.list("transaction", 10)->entries.empty());
    CHECK(files_of(storage) == before);
}

TEST_CASE("file transaction: the last word for a name counts")
{
    MemoryStorage storage;
    fill(storage);
    FileTransaction change{storage, "transaction"};
    REQUIRE(change.replace("a", bytes_of("first"), FileAccess::Everyone));
    REQUIRE(change.replace("a", bytes_of("second"), FileAccess::Owner));
    REQUIRE(change.remove("b"));
    REQUIRE(change.replace("b", bytes_of("back"), FileAccess::Everyone));
    REQUIRE(change.replace("to/d", bytes_of("x"), FileAccess::Everyone));
    REQUIRE(change.remove("to/d"));
    REQUIRE(change.remove("not there"));
    REQUIRE(change.commit());
    CHECK(files_of(storage) == Files{{"a", "second"}, {"b", "back"}, {"to/c", "goes"}});
    CHECK_FALSE(storage.is_open_to_others("a"));
    CHECK(storage.list("transaction", 10)->entries.empty());
}

TEST_CASE("file transaction: what cannot be done is refused before it is decided")
{
    MemoryStorage storage;
    fill(storage);
    FileTransaction change{storage, "transaction"};
    CHECK(change.replace("../a", {}, FileAccess::Owner).error() == StorageError::BadName);
    CHECK(change.remove("/").error() == StorageError::BadName);
    CHECK(change.replace("no/a", {}, FileAccess::Owner).error() == StorageError::NotFound);
    CHECK(change.replace("to", {}, FileAccess::Owner).error() == StorageError::Failed);
    storage.set_capacity(40);
    CHECK_FALSE(prepare(change));
    storage.set_capacity(UINT64_MAX);
    change.cancel();
    REQUIRE(prepare(change));
    storage.set_protected(true);
    CHECK(change.commit().error() == StorageError::Protected);
    CHECK_FALSE(change.is_decided());
    storage.set_protected(false);
    CHECK(files_of(storage) == before);
    REQUIRE(change.commit());
    CHECK(files_of(storage) == after);
}

TEST_CASE("file transaction: a power cut leaves the old files or the new ones", "[power]")
{
    bool is_done = false;
    bool was_new = false;
    for (std::size_t step = 0; !is_done; ++step) {
        MemoryStorage storage;
        fill(storage);
        storage.cut_power_after(step);
        is_done = run(storage);
        storage.restore_power();
        restart(storage);
        INFO("after " << step << " steps");
        const Files now = files_of(storage);
        const bool is_new = now == after;
        REQUIRE((is_new || now == before));
        REQUIRE((is_new || !was_new));
        was_new = is_new;
        REQUIRE(step < 1'000);
    }
    CHECK(was_new);
}

TEST_CASE("file transaction: and a second cut, while the first is mended", "[power]")
{
    for (std::size_t first = 0; first < 300; first += 3) {
        for (std::size_t second = 0; second < 12; ++second) {
            MemoryStorage storage;
            fill(storage);
            storage.cut_power_after(first);
            static_cast<void>(run(storage));
            storage.restore_power();
            storage.cut_power_after(second);
            FileTransaction half{storage, "transaction"};
            static_cast<void>(half.recover());
            storage.restore_power();
            restart(storage);
            const Files now = files_of(storage);
            INFO("after " << first << " steps and " << second);
            REQUIRE((now == after || now == before));
        }
    }
}

TEST_CASE("file transaction: what is decided stays, whatever fails in the next one", "[power]")
{
    std::size_t all_steps = 0;
    {
        MemoryStorage storage;
        fill(storage);
        const std::size_t begin = storage.steps();
        REQUIRE(run(storage));
        all_steps = storage.steps() - begin;
    }
    // Each byte is a step; of those after the decision each moves or removes a file.
    constexpr std::size_t last_steps = 12;
    REQUIRE(all_steps > last_steps);
    std::size_t decided = 0;
    for (std::size_t first = all_steps - last_steps; first < all_steps; ++first) {
        for (std::size_t second = 0; second < all_steps; ++second) {
            MemoryStorage storage;
            fill(storage);
            storage.fail_once_after(first, StorageError::Failed);
            bool is_decided = false;
            {
                FileTransaction change{storage, "transaction"};
                is_decided = prepare(change) && (change.commit() || change.is_decided());
            }
            storage.restore_power();
            storage.fail_once_after(second, StorageError::Failed);
            bool is_next_decided = false;
            {
                FileTransaction next{storage, "transaction"};
                const auto staged = next.replace("a", bytes_of("newest"), FileAccess::Everyone);
                is_next_decided = (staged && next.commit()) || next.is_decided();
            }
            storage.restore_power();
            restart(storage);
            Files expected = is_decided ? after : before;
            if (is_next_decided) {
                expected["a"] = "newest";
            }
            INFO("faults after " << first << " and " << second << " steps");
            REQUIRE(files_of(storage) == expected);
            decided += is_decided ? 1U : 0U;
        }
    }
    CHECK(decided > 0);
}

TEST_CASE("file transaction: a power cut on a disk", "[power]")
{
    failing_disk::Steps steps;
    {
        const TemporaryFolder folder;
        FolderStorage storage{folder.path.string()};
        fill(storage);
        steps = failing_disk::steps_of([&] { REQUIRE(run(storage)); });
    }
    bool was_new = false;
    for (const std::size_t step : steps.calls) {
        for (const bool is_killed : {false, true}) {
            const TemporaryFolder folder;
            FolderStorage storage{folder.path.string()};
            fill(storage);
            const auto operation = [&] { static_cast<void>(run(storage)); };
            if (is_killed) {
                REQUIRE(failing_disk::run_until_killed(step, operation));
            } else {
                failing_disk::run_until_dark(step, operation);
            }
            restart(storage);
            INFO("after " << step << " of " << steps.count << " steps");
            const Files now = files_of(storage);
            REQUIRE((now == before || now == after));
            was_new = was_new || now == after;
        }
    }
    CHECK(was_new);
}

TEST_CASE("file transaction: a journal that makes no sense moves nothing")
{
    MemoryStorage storage;
    fill(storage);
    REQUIRE(storage.make_folder("transaction", FileAccess::Owner));
    for (const char* journal :
         {"", "{}", "[7]", R"([{"name":"../a"}])", R"([{"name":"a","staged":"to/c"}])",
          R"([{"name":"a","staged":"transaction/../b"}])", R"([{"name":"a","staged":7}])"}) {
        INFO(journal);
        REQUIRE(put(storage, "transaction/journal.json", journal));
        FileTransaction change{storage, "transaction"};
        CHECK(change.recover().error() == StorageError::Failed);
        CHECK(files_of(storage) == before);
    }
}

} // namespace file_transaction_test
