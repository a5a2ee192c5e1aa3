#include <catch2/catch.hpp>

#include <string>
#include <string_view>

#include <busbar/core/status_codes.hpp>

#include "administration/open_files.hpp"
#include "administration/transfer_files.hpp"

namespace transfer_files_test {

// Part 20, 4.4: temporary files, without a server.

using namespace busbar;
using namespace std::chrono_literals;
using administration::TemporaryFileTransfer;
using administration::detail::Holder;
using administration::detail::TransferFile;
using administration::detail::TransferFiles;

namespace {

const NodeId one{1, "one"};
const NodeId two{1, "two"};

std::vector<std::byte> bytes_of(std::string_view text)
{
    const auto bytes = std::as_bytes(std::span{text});
    return {bytes.begin(), bytes.end()};
}

struct Transfers {
    std::uint32_t add(const Holder& holder, std::string name, std::string_view text,
                      bool is_written = false)
    {
        TransferFile file;
        file.name = std::move(name);
        file.holder = holder;
        *file.bytes = bytes_of(text);
        file.is_written = is_written;
        return files.add(std::move(file), now).handle;
    }
    std::string text(TransferFile& file, std::int32_t length)
    {
        const auto read = TransferFiles::read(file, length);
        return read ? std::string{reinterpret_cast<const char*>(read->data()), read->size()}
                    : std::string{name(read.error())};
    }
    std::string why_no_room(const Holder& holder)
    {
        const auto room = files.room(holder);
        return room ? std::to_string(*room) : std::string{name(room.error())};
    }
    std::vector<std::string> expire(bool has_two = true)
    {
        std::vector<std::string> gone;
        const auto is_there = [&](const Holder& holder) { return holder == one || has_two; };
        while (const auto* const file = files.find_gone(now, is_there)) {
            gone.push_back(file->name);
            files.remove(*file);
        }
        return gone;
    }

    TimePoint now{};
    TransferFiles files{TemporaryFileTransfer{
        .name = "backup",
        .limits = {.max_file_size = 10, .max_held = 16, .max_open = 3, .max_open_of_session = 2},
        .client_processing_timeout = 1s}};
};

using Names = std::vector<std::string>;

} // namespace

TEST_CASE("transfer files: are read from where they stand")
{
    Transfers transfers;
    auto& file = *transfers.files.find(transfers.add(one, "a", "0123456789"), one, transfers.now);
    CHECK(transfers.text(file, 4) == "0123");
    CHECK(transfers.text(file, 0).empty());
    CHECK(transfers.text(file, INT32_MAX) == "456789");
    CHECK(transfers.text(file, 4).empty());
    CHECK(transfers.text(file, -1) == "Bad_InvalidArgument");
    TransferFiles::set_position(file, 8);
    CHECK(transfers.text(file, 4) == "89");
    TransferFiles::set_position(file, UINT64_MAX);
    CHECK(file.position == 10);
    CHECK(transfers.files.write(file, bytes_of("x")) == status::Bad_InvalidState);
}

TEST_CASE("transfer files: are written up to their limits")
{
    Transfers transfers;
    auto& file = *transfers.files.find(transfers.add(one, "a", "", true), one, transfers.now);
    CHECK(transfers.files.write(file, bytes_of("01234567")) == status::Good);
    TransferFiles::set_position(file, 6);
    CHECK(transfers.files.write(file, bytes_of("xyz")) == status::Good);
    CHECK(*file.bytes == bytes_of("012345xyz"));
    CHECK(transfers.files.write(file, bytes_of("89")) == status::Bad_EncodingLimitsExceeded);
    CHECK(*file.bytes == bytes_of("012345xyz"));
    CHECK(transfers.text(file, 1) == "Bad_InvalidState");

    auto& other = *transfers.files.find(transfers.add(two, "b", "", true), two, transfers.now);
    CHECK(transfers.files.write(other, bytes_of("12345678")) == status::Bad_OutOfMemory);
    CHECK(transfers.files.write(other, bytes_of("1234567")) == status::Good);
    CHECK(transfers.why_no_room(two) == "Bad_OutOfMemory");
}

TEST_CASE("transfer files: how many may be written at once is limited by itself")
{
    TransferFiles files{TemporaryFileTransfer{.name = "project", .limits = {.max_written = 1}}};
    const auto written = files.add({.name = "a", .holder = one, .is_written = true}, TimePoint{});
    CHECK(files.room(two));
    REQUIRE_FALSE(files.room_to_write(two));
    CHECK(files.room_to_write(two).error() == status::Bad_TooManyOperations);
    files.remove(*files.find(written.handle, one, TimePoint{}));
    files.add({.name = "b", .holder = one}, TimePoint{});
    CHECK(files.room_to_write(two));
}

TEST_CASE("transfer files: how many there may be is limited")
{
    Transfers transfers;
    CHECK(transfers.why_no_room(one) == "10");
    transfers.add(one, "a", "0123456789");
    CHECK(transfers.why_no_room(one) == "6");
    transfers.add(one, "b", "");
    CHECK(transfers.why_no_room(one) == "Bad_TooManyOperations");
    CHECK(transfers.why_no_room(two) == "6");
    const auto handle = transfers.add(two, "c", "");
    CHECK(transfers.why_no_room(two) == "Bad_TooManyOperations");
    transfers.files.remove(*transfers.files.find(handle, two, transfers.now));
    CHECK(transfers.files.find(handle, two, transfers.now) == nullptr);
    CHECK(transfers.why_no_room(two) == "6");
}

TEST_CASE("transfer files: no user has all of them, with however many sessions")
{
    Transfers transfers;
    const Holder newcomer{NodeId{1, "new"}, 0, "somebody else"};
    transfers.add(one, "a", "", true);
    transfers.add(one, "b", "");
    transfers.add(two, "c", "");
    CHECK(transfers.why_no_room(two) == "Bad_TooManyOperations");
    CHECK(transfers.why_no_room(newcomer) == "10");
    CHECK(transfers.files.find("b", transfers.now) == nullptr); // the first that is only read
    CHECK(transfers.expire() == Names{"b"});

    // Nor all of the bytes; of those the largest goes.
    transfers.add(newcomer, "d", "", true);
    auto& written = *transfers.files.find(1, one, transfers.now);
    CHECK(transfers.files.write(written, bytes_of("0123456789")) == status::Good);
    auto& his = *transfers.files.find(4, newcomer, transfers.now);
    CHECK(transfers.files.write(his, bytes_of("0123456")) == status::Good);
    CHECK(transfers.expire() == Names{"a"});
}

TEST_CASE("transfer files: who holds most of the bytes gives way")
{
    Transfers transfers;
    const Holder newcomer{NodeId{1, "new"}, 0, "somebody else"};
    transfers.add(one, "a", "012345");
    transfers.add(two, "b", "0123456789");
    CHECK(transfers.why_no_room(newcomer) == "10");
    CHECK(transfers.expire() == Names{"b"});
    CHECK(transfers.files.find("a", transfers.now) != nullptr);
}

TEST_CASE("transfer files: a handle holds for its session and its file")
{
    Transfers transfers;
    const auto first = transfers.add(one, "a", "x");
    const auto second = transfers.add(two, "b", "x");
    CHECK(first != second);
    auto& files = transfers.files;
    CHECK(files.find(first, two, transfers.now) == nullptr);
    CHECK(files.find(first, one, "b", transfers.now) == nullptr);
    CHECK(files.find(second, one, "b", transfers.now) == nullptr);
    CHECK(files.find(0, one, transfers.now) == nullptr);
    CHECK(files.find(first, one, "a", transfers.now) != nullptr);
}

TEST_CASE("transfer files: go when their time is over, or their session")
{
    Transfers transfers;
    const auto first = transfers.add(one, "a", "x");
    const auto second = transfers.add(two, "b", "x");
    transfers.now += 900ms;
    CHECK(transfers.files.find(first, one, transfers.now) != nullptr); // its time begins anew
    transfers.now += 100ms;
    CHECK(transfers.files.find(second, two, transfers.now) == nullptr); // before it is removed
    CHECK(transfers.files.find("b", transfers.now) == nullptr);
    CHECK(transfers.expire() == Names{"b"});
    CHECK(transfers.files.find("a", transfers.now) != nullptr);
    transfers.add(two, "c", "x");
    CHECK(transfers.expire(false) == Names{"c"});
    transfers.now += 1s;
    CHECK(transfers.expire() == Names{"a"});
    CHECK(transfers.expire().empty());
}

} // namespace transfer_files_test
