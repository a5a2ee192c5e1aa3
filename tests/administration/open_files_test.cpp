#include <catch2/catch.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/status_codes.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "administration/open_files.hpp"

namespace open_files_test {

// Part 20, 4.2: what a FileType does, without a server.

using namespace busbar;
using namespace busbar::administration;
using administration::detail::Holder;
using administration::detail::OpenFiles;

namespace {

const Holder one{NodeId{1, "one"}};
const Holder two{NodeId{1, "two"}};
const Holder three{NodeId{1, "three"}};

constexpr std::uint8_t read = 1;
constexpr std::uint8_t write = 2;
constexpr std::uint8_t erase = 4;
constexpr std::uint8_t append = 8;

std::span<const std::byte> bytes_of(std::string_view text)
{
    return std::as_bytes(std::span{text});
}

struct Files {
    Files() { put("a", "first"); }
    void put(std::string_view path, std::string_view text)
    {
        REQUIRE(storage.replace(path, bytes_of(text), FileAccess::Owner));
    }
    [[nodiscard]] std::string stored(std::string_view path)
    {
        std::vector<std::byte> bytes(1'000);
        const auto count = storage.read(path, 0, bytes);
        REQUIRE(count);
        return {reinterpret_cast<const char*>(bytes.data()), *count};
    }
    std::uint32_t open(std::string_view path, int mode, const Holder& session = one)
    {
        const auto handle = files.open(path, static_cast<std::uint8_t>(mode), session);
        REQUIRE(handle);
        return *handle;
    }
    std::string_view why_not(std::string_view path, int mode, const Holder& session = one)
    {
        const auto handle = files.open(path, static_cast<std::uint8_t>(mode), session);
        return name(handle ? StatusCode{status::Good} : handle.error());
    }
    std::string text(std::uint32_t handle, std::int32_t length = 1'000, const Holder& session = one)
    {
        const auto read = files.read({"a", handle, session}, length);
        return read ? std::string{reinterpret_cast<const char*>(read->data()), read->size()}
                    : std::string{name(read.error())};
    }
    std::string_view add(std::uint32_t handle, std::string_view text)
    {
        return name(files.write({"a", handle, one}, bytes_of(text)));
    }
    std::string_view close(std::uint32_t handle, const Holder& session = one)
    {
        return name(files.close({"a", handle, session}));
    }

    storage::MemoryStorage storage;
    FileLimits limits{.max_file_size = 100,
                      .max_written = 150,
                      .max_open = 6,
                      .max_open_of_session = 4,
                      .max_entries = 10,
                      .max_depth = 2};
    OpenFiles files{storage, limits};
};

} // namespace

TEST_CASE_METHOD(Files, "files: are read from where they are")
{
    const auto handle = open("a", read);
    CHECK(text(handle, 2) == "fi");
    CHECK(files.position({"a", handle, one}) == 2U);
    CHECK(text(handle) == "rst");
    CHECK(text(handle).empty());
    CHECK(files.set_position({"a", handle, one}, 1) == status::Good);
    CHECK(text(handle, 3) == "irs");
    CHECK(files.set_position({"a", handle, one}, 1'000) == status::Good);
    CHECK(files.position({"a", handle, one}) == 5U); // the end
    CHECK(text(handle, -1) == "Bad_InvalidArgument");
    CHECK(add(handle, "x") == "Bad_InvalidState");
    CHECK(close(handle) == "Good");
    CHECK(close(handle) == "Bad_InvalidArgument");
    CHECK(stored("a") == "first");
}

TEST_CASE_METHOD(Files, "files: are what was written once they are closed")
{
    auto handle = open("a", write | erase);
    CHECK(add(handle, "sec") == "Good");
    CHECK(add(handle, "ond") == "Good");
    CHECK(text(handle) == "Bad_InvalidState"); // not open for reading
    CHECK(stored("a") == "first");
    CHECK(close(handle) == "Good");
    CHECK(stored("a") == "second");

    handle = open("a", read | write | append);
    CHECK(add(handle, " one") == "Good");
    CHECK(files.set_position({"a", handle, one}, 0) == status::Good);
    CHECK(text(handle) == "second one");
    CHECK(files.set_position({"a", handle, one}, 0) == status::Good);
    CHECK(add(handle, "S") == "Good");
    CHECK(close(handle) == "Good");
    CHECK(stored("a") == "Second one");

    CHECK(close(open("a", write | erase)) == "Good");
    CHECK(stored("a").empty());
}

TEST_CASE_METHOD(Files, "files: have one writer or many readers")
{
    const auto reader = open("a", read);
    CHECK(why_not("a", read, two) == "Good");
    CHECK(files.count("a") == 2);
    CHECK(why_not("a", write) == "Bad_NotWritable");
    files.expire([](const Holder&) { return false; });
    CHECK(text(reader) == "Bad_InvalidArgument");
    const auto writer = open("a", write);
    CHECK(why_not("a", read, two) == "Bad_NotReadable");
    CHECK(why_not("a", read | write, two) == "Bad_NotWritable");
    CHECK(close(writer, two) == "Bad_InvalidArgument"); // another's
    CHECK(files.read({"b", writer, one}, 1).error() == status::Bad_InvalidArgument);
    // A client that vanishes has written nothing.
    CHECK(add(writer, "half") == "Good");
    files.expire([](const Holder& holder) { return holder == two; });
    CHECK(stored("a") == "first");
    CHECK(why_not("a", write, two) == "Good");
}

TEST_CASE_METHOD(Files, "files: who reads one in another session keeps no writer out")
{
    const auto reader = open("a", read);
    CHECK(text(reader, 2) == "fi");
    const auto writer = open("a", write | erase, two);
    CHECK(files.write({"a", writer, two}, bytes_of("second, longer")) == status::Good);
    CHECK(close(writer, two) == "Good");
    CHECK(stored("a") == "second, longer");
    // What it was at Open, for each reader, however often it is replaced.
    const auto later = open("a", read, two);
    const auto again = open("a", write | erase, three);
    CHECK(close(again, three) == "Good");
    CHECK(stored("a").empty());
    CHECK(text(reader) == "rst");
    CHECK(files.set_position({"a", reader, one}, 0) == status::Good);
    CHECK(text(reader) == "first");
    CHECK(text(later, 1'000, two) == "second, longer");
    CHECK(text(open("a", read)).empty());
}

TEST_CASE_METHOD(Files,
                 "files: what readers keep of former contents makes room for what is written")
{
    put("a", std::string(90, 'a'));
    const auto reader = open("a", read);
    const auto writer = open("a", write | erase, two);
    CHECK(close(writer, two) == "Good");
    CHECK(text(reader, 10) == std::string(10, 'a'));
    put("b", std::string(80, 'b'));
    const auto other = open("b", write, two); // 90 + 80 > 150
    CHECK(text(reader, 10) == "Bad_InvalidState");
    CHECK(files.close({"b", other, two}) == status::Good);
}

TEST_CASE_METHOD(Files, "files: what is gone is open for nobody")
{
    put("c", "c");
    const auto handle = open("c", read);
    CHECK(files.is_in_use("c", one));
    CHECK_FALSE(files.is_in_use("c", two));
    files.drop("c");
    CHECK(files.close({"c", handle, one}) == status::Bad_InvalidArgument);
    const auto writer = open("c", write);
    CHECK(files.is_in_use("c", two));
    files.drop("b");
    CHECK(files.close({"c", writer, one}) == status::Good);
}

TEST_CASE_METHOD(Files, "files: no user has all handles, with however many sessions")
{
    const std::string_view other = "somebody else";
    const Holder newcomer{NodeId{1, "new"}, 0, std::string{other}};
    const auto changed = open("a", write);
    CHECK(add(changed, "x") == "Good");
    put("b", "b");
    const auto first = open("b", read);
    for (int i = 0; i < 4; ++i) { // all six of one user
        static_cast<void>(open("b", read, i < 2 ? two : three));
    }
    CHECK(why_not("b", read) == "Bad_TooManyOperations");
    // The first of those that lose nothing gives way, until both have as many.
    for (int i = 0; i < 3; ++i) {
        CHECK(why_not("b", read, newcomer) == "Good");
    }
    CHECK(why_not("b", read, newcomer) == "Bad_TooManyOperations");
    CHECK(files.read({"b", first, one}, 1).error() == status::Bad_InvalidArgument);
    CHECK(close(changed) == "Good");
    CHECK(stored("a") == "xirst");
}

TEST_CASE_METHOD(Files, "files: no user has all memory for what is written")
{
    const Holder newcomer{NodeId{1, "new"}, 0, "somebody else"};
    for (const char* name : {"b", "c"}) {
        put(name, "");
    }
    const auto small = open("a", write | erase);
    CHECK(add(small, std::string(60, 'x')) == "Good");
    const auto large = open("b", write | erase, two);
    CHECK(files.write({"b", large, two}, bytes_of(std::string(90, 'x'))) == status::Good);
    const auto his = open("c", write, newcomer);
    CHECK(files.write({"c", his, newcomer}, bytes_of(std::string(80, 'y'))) == status::Good);
    CHECK(files.close({"b", large, two}) == status::Bad_InvalidArgument); // the larger one
    CHECK(add(small, std::string(20, 'x')) == "Bad_OutOfMemory");         // no more than he has
    CHECK(files.write({"c", his, newcomer}, bytes_of(std::string(15, 'y'))) ==
          status::Bad_OutOfMemory); // nor more than the other one
    CHECK(close(small) == "Good");
}

TEST_CASE_METHOD(Files, "files: what is no mode and no file is refused")
{
    for (const int mode : {0, 4, 8, 5, 16, 0xFF, 0x81}) {
        INFO(mode);
        CHECK(why_not("a", mode) == "Bad_InvalidArgument");
    }
    CHECK(why_not("b", read) == "Bad_NotFound");
    REQUIRE(storage.make_folder("c", FileAccess::Owner));
    CHECK(why_not("c", read) == "Bad_NotFound");
}

TEST_CASE_METHOD(Files, "files: what clients hold is limited")
{
    const std::string large(101, 'x');
    auto handle = open("a", write);
    CHECK(add(handle, large) == "Bad_EncodingLimitsExceeded");
    CHECK(add(handle, large.substr(0, 100)) == "Good");
    put("b", large.substr(0, 60));
    put("c", large);
    CHECK(why_not("b", write) == "Bad_OutOfMemory");
    CHECK(why_not("c", write) == "Bad_EncodingLimitsExceeded");
    CHECK(why_not("c", read) == "Good");
    CHECK(why_not("c", read) == "Good");
    CHECK(why_not("c", read) == "Good");
    CHECK(why_not("c", read) == "Bad_TooManyOperations");
    CHECK(why_not("c", read, two) == "Good");
    CHECK(why_not("c", read, two) == "Good");
    CHECK(why_not("c", read, two) == "Bad_TooManyOperations"); // of all
    CHECK(close(handle) == "Good");
    handle = open("b", write, two);
    CHECK(files.write({"b", handle, two}, bytes_of(large.substr(0, 41))) == status::Good);
    CHECK(files.is_in_use("b", two));
    CHECK_FALSE(files.is_in_use("a", two));
}

TEST_CASE_METHOD(Files, "files: somebody else's change is not overwritten")
{
    const auto writer = open("a", write);
    CHECK(add(writer, "mine") == "Good");
    put("a", "another");
    CHECK(close(writer) == "Bad_InvalidState");
    CHECK(stored("a") == "another");
    const auto reader = open("a", read);
    put("a", "a third");
    CHECK(text(reader) == "Bad_InvalidState");
    REQUIRE(storage.remove("a"));
    CHECK(text(reader) == "Bad_NotFound");
}

TEST_CASE_METHOD(Files, "files: what cannot be kept can be tried again")
{
    const auto writer = open("a", write | erase);
    CHECK(add(writer, "second") == "Good");
    storage.set_protected(true);
    CHECK(close(writer) == "Bad_ResourceUnavailable");
    storage.set_protected(false);
    CHECK(stored("a") == "first");
    CHECK(close(writer) == "Good");
    CHECK(stored("a") == "second");
    storage.set_away(true);
    CHECK(why_not("a", read) == "Bad_ResourceUnavailable");
}

} // namespace open_files_test
