#include <chrono>
#include <future>
#include <thread>

#include <busbar/core/status_codes.hpp>
#include <busbar/core/storage_gate.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "media.hpp"

namespace storage_gate_test {

using namespace busbar;
using namespace busbar::test;
using storage::MemoryStorage;

TEST_CASE("storage gate: what is closed is read, and changes by the other way only")
{
    MemoryStorage files;
    StorageGate gate{files};
    REQUIRE(gate.make_folder("folder", FileAccess::Owner));
    REQUIRE(put(gate, "a", "1"));
    REQUIRE(add(gate, "a", "2"));
    CHECK(read(files, "a") == "12");
    CHECK_FALSE(gate.is_closed());

    gate.close();
    CHECK(gate.is_closed());
    CHECK(put(gate, "a", "3").error() == StorageError::Closed);
    CHECK(put(gate, "b", "3").error() == StorageError::Closed);
    CHECK(add(gate, "a", "3").error() == StorageError::Closed);
    CHECK(gate.move("a", "b", WhenThere::Replace).error() == StorageError::Closed);
    CHECK(gate.remove("a").error() == StorageError::Closed);
    CHECK(gate.remove("folder").error() == StorageError::Closed);
    CHECK(gate.make_folder("other", FileAccess::Owner).error() == StorageError::Closed);
    CHECK(gate.close_to_others("a").error() == StorageError::Closed);
    CHECK(files.names() == std::vector<std::string>{"a"});
    CHECK(read(gate, "a") == "12");
    CHECK(gate.entry("a")->size == 2);
    CHECK(gate.list("", 9)->entries.size() == 2);
    CHECK(gate.place("a") == files.place("a"));
    CHECK(gate.free_space() == files.free_space());

    REQUIRE(put(files, "a", "restored"));
    CHECK(read(gate, "a") == "restored");
    CHECK(status_of(StorageError::Closed) == status::Bad_InvalidState);
    CHECK(text(StorageError::Closed) == "no further changes are accepted before a restart");
}

TEST_CASE("storage gate: who comes while it is held waits, and is refused if it was closed then")
{
    MemoryStorage files;
    for (const bool closes : {false, true}) {
        StorageGate gate{files};
        std::future<Stored<void>> other;
        gate.hold([&] {
            other = std::async(std::launch::async, [&] { return put(gate, "a", "late"); });
            static_cast<void>(put(files, "a", "held"));
            if (closes) {
                gate.close();
            }
            CHECK(other.wait_for(std::chrono::seconds{0}) != std::future_status::ready);
            CHECK(read(files, "a") == "held");
        });
        const auto done = other.get();
        CHECK(done.has_value() != closes);
        CHECK(read(files, "a") == (closes ? "held" : "late"));
    }
}

} // namespace storage_gate_test
