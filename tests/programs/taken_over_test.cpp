#include "product/store/taken_over.hpp"

#include <catch2/catch.hpp>

#include <memory>
#include <span>
#include <string>

#include <busbar/storage/memory_storage.hpp>

namespace taken_over_test {

using namespace busbar;
using product::TakenOver;
using product::TakenOverFiles;

// What a controller keeps of what it ran with.

namespace {

TakenOver everything()
{
    TakenOver all;
    all.files.emplace("a b.toml", std::make_shared<const std::string>("x = 1\n\xFF"));
    all.files.emplace("press.st", std::make_shared<const std::string>(""));
    all.settings = "{}";
    all.project = std::make_shared<const std::string>("busbar project 1\n");
    all.listeners = {{"", 4'840, product::ListenerUse::Data},
                     {"fe80::1%eth0", 65'535, product::ListenerUse::Administration}};
    return all;
}

void flip(Storage& storage, const std::string& name)
{
    auto bytes = *read_file(storage, name, 1'000'000);
    bytes.back() ^= std::byte{1};
    REQUIRE(storage.replace(name, bytes, FileAccess::Owner));
}

} // namespace

TEST_CASE("taken over: what is kept is read again")
{
    storage::MemoryStorage storage;
    CHECK_FALSE(TakenOverFiles{storage}.read());
    REQUIRE(TakenOverFiles{storage}.keep(everything()));
    const auto all = TakenOverFiles{storage}.read();
    REQUIRE(all);
    REQUIRE(all->files.size() == 2);
    CHECK(*all->files.at("a b.toml") == "x = 1\n\xFF");
    CHECK(all->files.at("press.st")->empty());
    CHECK(all->settings == "{}");
    CHECK(all->project_text() == everything().project_text());
    CHECK(all->listeners == everything().listeners);
}

TEST_CASE("taken over: what there is nothing to say of stays as it was kept")
{
    storage::MemoryStorage storage;
    TakenOverFiles files{storage};
    REQUIRE(files.keep(everything()));
    REQUIRE(files.keep({}));
    const auto all = files.read();
    REQUIRE(all);
    CHECK(all->files.empty());
    CHECK(all->project == nullptr);
    CHECK(all->settings == "{}");
    CHECK(all->listeners.size() == 2);
}

TEST_CASE("taken over: a part is written when it is another one, and only then")
{
    storage::MemoryStorage storage;
    TakenOverFiles files{storage};
    REQUIRE(files.keep(everything()));
    REQUIRE(storage.remove("taken-over/files"));
    REQUIRE(storage.remove("taken-over/project"));
    TakenOver changed = everything();
    changed.project = std::make_shared<const std::string>("busbar project 2\n");
    REQUIRE(files.keep(changed));
    CHECK_FALSE(storage.entry("taken-over/files"));
    CHECK(storage.entry("taken-over/project"));
}

TEST_CASE("taken over: a damaged part is not there")
{
    storage::MemoryStorage storage;
    REQUIRE(TakenOverFiles{storage}.keep(everything()));
    flip(storage, "taken-over/files");
    flip(storage, "taken-over/listeners");
    const auto all = TakenOverFiles{storage}.read();
    REQUIRE(all);
    CHECK(all->files.empty());
    CHECK(all->listeners.empty());
    CHECK(all->project_text() == everything().project_text());
}

TEST_CASE("taken over: a copy of a file is kept as long as there is one, and not if it is damaged")
{
    storage::MemoryStorage storage;
    const auto put = [&](std::string_view text) {
        REQUIRE(storage.replace("roles.json", std::as_bytes(std::span{text}), FileAccess::Owner));
    };
    TakenOverFiles files{storage};
    REQUIRE(files.keep_copy("roles.json"));
    CHECK_FALSE(TakenOverFiles{storage}.copy("roles.json"));
    put("some");
    REQUIRE(files.keep_copy("roles.json"));
    CHECK(TakenOverFiles{storage}.copy("roles.json") == "some");
    put("other");
    CHECK(TakenOverFiles{storage}.copy("roles.json") == "some");
    REQUIRE(files.keep_copy("roles.json"));
    CHECK(TakenOverFiles{storage}.copy("roles.json") == "other");
    flip(storage, "taken-over/roles.json");
    CHECK_FALSE(TakenOverFiles{storage}.copy("roles.json"));
    REQUIRE(TakenOverFiles{storage}.keep_copy("roles.json"));
    CHECK(TakenOverFiles{storage}.copy("roles.json") == "other");
    REQUIRE(storage.remove("roles.json"));
    REQUIRE(TakenOverFiles{storage}.keep_copy("roles.json"));
    CHECK_FALSE(storage.entry("taken-over/roles.json"));
    // Nothing of it is what a controller ran with.
    put("some");
    REQUIRE(TakenOverFiles{storage}.keep_copy("roles.json"));
    CHECK_FALSE(TakenOverFiles{storage}.read());
}

} // namespace taken_over_test
