#include "product/machine/machine_medium.hpp"

#include <catch2/catch.hpp>

#include <span>
#include <string_view>

#include <busbar/product/runtime.hpp>

#include "support/temporary_folder.hpp"

namespace machine_medium_test {

using namespace busbar;
using product::MachineMedium;
using product::StorageMedium;
using State = StorageMedium::State;

namespace {

std::span<const std::byte> bytes_of(std::string_view text)
{
    return std::as_bytes(std::span{text});
}

template <typename T>
StorageError error_of(const Stored<T>& stored)
{
    REQUIRE_FALSE(stored);
    return stored.error();
}

struct Fixture {
    [[nodiscard]] std::string path(const std::string& in) const
    {
        return (folder.path / in).string();
    }

    test::TemporaryFolder folder;
    StorageMedium card;
    MachineMedium medium{path("configured"), &card};
};

} // namespace

TEST_CASE("a medium of no runtime is the folder of the configuration")
{
    const test::TemporaryFolder folder;
    MachineMedium medium{(folder.path / "configured").string(), nullptr};
    CHECK(medium.is_configured());
    CHECK(error_of(medium.free_space()) == StorageError::Away);
    REQUIRE(medium.make_folder("", FileAccess::Owner));
    REQUIRE(medium.append("log", bytes_of("text"), FileAccess::Owner));
    CHECK(medium.entry("log")->size == 4);
    CHECK(medium.place("log") == (folder.path / "configured/log").string());
}

TEST_CASE_METHOD(Fixture, "a runtime's medium is as the runtime says")
{
    REQUIRE(medium.make_folder("", FileAccess::Owner));
    REQUIRE(medium.append("log", bytes_of("text"), FileAccess::Owner));

    card.set(State::Away);
    CHECK(error_of(medium.free_space()) == StorageError::Away);
    CHECK(error_of(medium.entry("log")) == StorageError::Away);
    CHECK(error_of(medium.append("log", bytes_of("more"), FileAccess::Owner)) ==
          StorageError::Away);
    CHECK(error_of(medium.list("", 10)) == StorageError::Away);
    CHECK(error_of(medium.remove("log")) == StorageError::Away);
    CHECK(error_of(medium.make_folder("", FileAccess::Owner)) == StorageError::Away);

    card.set(State::Protected);
    CHECK(medium.entry("log"));
    CHECK(medium.list("", 10)->entries.size() == 1);
    CHECK(error_of(medium.replace("log", bytes_of("more"), FileAccess::Owner)) ==
          StorageError::Protected);
    CHECK(error_of(medium.append("log", bytes_of("more"), FileAccess::Owner)) ==
          StorageError::Protected);
    CHECK(error_of(medium.move("log", "other", WhenThere::Refuse)) == StorageError::Protected);
    CHECK(error_of(medium.remove("log")) == StorageError::Protected);

    card.set(State::Full);
    CHECK(medium.free_space() == std::uint64_t{0});
    CHECK(error_of(medium.append("log", bytes_of("more"), FileAccess::Owner)) ==
          StorageError::Full);
    CHECK(medium.move("log", "other", WhenThere::Refuse));
    CHECK(medium.remove("other")); // which makes room

    card.set(State::Usable);
    CHECK(medium.append("log", bytes_of("more"), FileAccess::Owner));
}

TEST_CASE_METHOD(Fixture, "a runtime's medium lies where it says, from the next use on")
{
    REQUIRE(medium.make_folder("", FileAccess::Owner));
    card.lie_in(path("card"));
    CHECK_FALSE(medium.is_configured());
    CHECK(error_of(medium.append("log", bytes_of("text"), FileAccess::Owner)) ==
          StorageError::Away);
    test::fs::create_directory(path("card"));
    CHECK(medium.append("log", bytes_of("text"), FileAccess::Owner));
    CHECK(test::fs::exists(path("card/log")));
    test::fs::create_directory(path("other"));
    card.lie_in(path("other"));
    CHECK(error_of(medium.entry("log")) == StorageError::NotFound);
    card.lie_in({});
    CHECK(medium.place("log") == path("configured/log"));
}

} // namespace machine_medium_test
