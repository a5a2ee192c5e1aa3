#include <functional>
#include <map>

#include "media.hpp"
#include "support/failing_disk.hpp"

namespace power_cut_test {

// After a power cut there is the state before a call or the one after it; of an append any first
// part. On a disk, and in the memory that other tests take for one.

using namespace busbar;
using namespace busbar::test;
using storage::FolderStorage;
using storage::MemoryStorage;

namespace {

using Files = std::map<std::string, std::string>;
using Change = std::function<Stored<void>(Storage&)>;

constexpr std::string_view appended = "two and a half\n";

void fill(Storage& storage)
{
    REQUIRE(storage.make_folder("to", FileAccess::Everyone));
    REQUIRE(put(storage, "a", "old"));
    REQUIRE(put(storage, "log", "one\n"));
    REQUIRE(put(storage, "to/b", "another"));
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

bool is_first_part(const std::string& part, const std::string& whole)
{
    return whole.compare(0, part.size(), part) == 0;
}

/// Whether that can be what a power cut leaves.
bool is_allowed(const Files& now, const Files& before, const Files& after)
{
    if (now == before || now == after) {
        return true;
    }
    Files rest = now;
    const std::string log = rest["log"];
    rest["log"] = before.at("log");
    return rest == before && log.size() >= before.at("log").size() &&
           is_first_part(log, after.at("log"));
}

const std::map<std::string, Change> changes{
    {"replace", [](Storage& storage) { return put(storage, "a", "something new"); }},
    {"make", [](Storage& storage) { return put(storage, "new", "something new"); }},
    {"append", [](Storage& storage) { return add(storage, "log", appended); }},
    {"move", [](Storage& storage) { return storage.move("a", "to/a", WhenThere::Refuse); }},
    {"move over", [](Storage& storage) { return storage.move("a", "to/b", WhenThere::Replace); }},
    {"remove", [](Storage& storage) { return storage.remove("a"); }},
};

Files result_of(const Change& change)
{
    MemoryStorage storage;
    fill(storage);
    REQUIRE(change(storage));
    return files_of(storage);
}

failing_disk::Steps steps_of(const Change& change)
{
    const TemporaryFolder folder;
    FolderStorage storage{folder.path.string()};
    fill(storage);
    return failing_disk::steps_of([&] { REQUIRE(change(storage)); });
}

} // namespace

TEST_CASE("storage: a power cut leaves the old files of a folder or the new ones", "[power]")
{
    for (const auto& entry : changes) {
        const std::string& name = entry.first;
        const Change& change = entry.second;
        const Files after = result_of(change);
        const auto run = [&](std::size_t step, bool is_dark) {
            const TemporaryFolder folder;
            FolderStorage storage{folder.path.string()};
            fill(storage);
            const Files before = files_of(storage);
            bool is_done = false;
            const auto operation = [&] { is_done = !!change(storage); };
            if (is_dark) {
                failing_disk::run_until_dark(step, operation);
            } else {
                REQUIRE(failing_disk::run_until_killed(step, operation));
            }
            INFO(name << " after " << step << " steps");
            const Files now = files_of(storage);
            CHECK(is_allowed(now, before, after));
            CHECK((!is_done || now == after));
            storage.remove_unfinished("");
            storage.remove_unfinished("to");
            CHECK(files_of(storage) == now);
        };
        const failing_disk::Steps steps = steps_of(change);
        REQUIRE_FALSE(steps.calls.empty());
        for (const std::size_t step : steps.calls) {
            run(step, true);
            run(step, false);
        }
    }
}

TEST_CASE("storage: a power cut leaves the old files in memory or the new ones", "[power]")
{
    for (const auto& entry : changes) {
        const std::string& name = entry.first;
        const Change& change = entry.second;
        const Files after = result_of(change);
        bool was_new = false;
        for (std::size_t step = 0; !was_new; ++step) {
            MemoryStorage storage;
            fill(storage);
            const Files before = files_of(storage);
            storage.cut_power_after(step);
            const bool is_done = !!change(storage);
            CHECK(is_done == !!storage.entry("log"));
            storage.restore_power();
            const Files now = files_of(storage);
            INFO(name << " after " << step << " steps");
            CHECK(is_allowed(now, before, after));
            CHECK((!is_done || now == after));
            was_new = is_done;
            REQUIRE(step < 100);
        }
    }
}

TEST_CASE("storage: a call that fails because the disk is full changes nothing", "[power]")
{
    for (const auto& entry : changes) {
        const std::string& name = entry.first;
        const Change& change = entry.second;
        const Files after = result_of(change);
        for (const std::size_t step : steps_of(change).calls) {
            const TemporaryFolder folder;
            FolderStorage storage{folder.path.string()};
            fill(storage);
            const Files before = files_of(storage);
            std::optional<StorageError> error;
            failing_disk::run_with_failure(step, [&] {
                const auto result = change(storage);
                error = result ? std::nullopt : std::optional{result.error()};
            });
            INFO(name << " at step " << step);
            const Files now = files_of(storage);
            CHECK(is_allowed(now, before, after));
            CHECK((error ? *error == StorageError::Full : now == after));
        }
    }
}

} // namespace power_cut_test
