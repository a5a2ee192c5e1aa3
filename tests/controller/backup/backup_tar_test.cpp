#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include <controller/backup/backup_file.hpp>
#include <controller/backup/tar.hpp>

#include "memory_fixture.hpp"
#include "sealed_backup.hpp"
#include "support/allocation_count.hpp"
#include "support/effort.hpp"

namespace backup_tar_test {

// Backup files are tars: what is in them, and what is refused.

using namespace busbar;
using namespace busbar::controller;
using busbar::test::BackupBytes;
using busbar::test::MemoryFixture;
using busbar::test::TarBlocks;
using busbar::test::Texts;
using controller::detail::TarReader;
using controller::detail::TarWriter;

namespace {

constexpr const char* long_name =
    "trusted/certs/A controller whose certificate has a name that is longer than a header of a tar "
    "can hold [0123456789ABCDEF0123456789ABCDEF01234567].der";
const BackupLabel label{"press 4", DateTime::from_unix_seconds(1'000'000)};

MemoryFixture::Files first_files()
{
    MemoryFixture::Files files = test::first_machine();
    files["trusted/certs/M\xC3\xBCller.der"] = "client 3";
    files["trusted/certs/back\\slash\nand line.der"] = "client 4";
    files[long_name] = std::string(513, 'x');
    return files;
}

BackupBytes first_backup(const MemoryFixture::Files& files = first_files())
{
    MemoryFixture machine;
    machine.put_all(files);
    return machine.memory.backup(label).value();
}

std::string refusal(const BackupBytes& backup)
{
    MemoryFixture machine;
    machine.put_all(test::second_machine());
    const auto done = machine.memory.restore(backup, {});
    CHECK((done || machine.files() == test::second_machine()));
    return done ? "restored" : text(done.error());
}

bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

struct NamedFile {
    std::string name;
    std::string content;
};
/// The name of a file that becomes an extended header later.
const std::string extended_header = "PaxHeaders/1";

/// A tar of these files with the right SHA256SUMS.
BackupBytes tar_of(const std::vector<NamedFile>& files)
{
    TarWriter tar{0};
    std::size_t room = 0;
    for (const NamedFile& file : files) {
        room += file.name == extended_header ? 0 : 64 + 2 + file.name.size() + 1;
    }
    const std::string blank(room, ' ');
    tar.add("SHA256SUMS", std::as_bytes(std::span{blank}));
    for (const NamedFile& file : files) {
        tar.add(file.name, std::as_bytes(std::span{file.content}));
    }
    return TarBlocks{tar.take()}.sealed();
}

/// A manifest with these files of the client certificates.
std::string manifest(const Texts& names, const std::string& version = R"("version":2,)")
{
    std::string files;
    for (const std::string& name : names) {
        files += (files.empty() ? "" : ",") + (R"({"name":")" + name + R"(","size":1})");
    }
    return "{" + version + R"("controller":"","created":"","opc_ua":true,"items":[{"name":)" +
           R"("Client certificates","group":"security","files":[)" + files + "]}]}";
}

const std::string a_name = "trusted/certs/a.der";
const std::string a_place = "files/trusted/certs/a.der";

/// The backup of one file, before something is changed in the header of that file.
TarBlocks with_a()
{
    return TarBlocks{tar_of({{"manifest.json", manifest({a_name})}, {a_place, "x"}})};
}

BackupBytes kept_file(const std::string& name)
{
    std::ifstream file{std::string{BUSBAR_SOURCE_DIR} + "/tests/controller/backup/earlier/" + name,
                       std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{file}, {}};
    const auto bytes = std::as_bytes(std::span{text});
    return {bytes.begin(), bytes.end()};
}

} // namespace

TEST_CASE("A backup file is a tar with checksums and a manifest (8-2-1)")
{
    const BackupBytes backup = first_backup();
    TarReader reader{backup};
    Texts names;
    MemoryFixture::Files contents;
    for (auto file = reader.next().value(); file; file = reader.next().value()) {
        names.push_back(file->name);
        contents[file->name] = controller::detail::as_text(file->bytes);
    }
    REQUIRE(names.size() > 2);
    // Names that are long or not ASCII.
    const TarBlocks blocks{backup};
    const auto all = blocks.headers();
    CHECK(std::ranges::count_if(
              all, [&](std::size_t at) { return blocks.text(at + 156, 1) == "x"; }) == 2);
    CHECK(names[0] == "SHA256SUMS");
    CHECK(names[1] == "manifest.json");
    CHECK(contents[a_place] == "client a");
    CHECK(contents["files/" + std::string{long_name}] == std::string(513, 'x'));
    CHECK(contents["files/trusted/certs/M\xC3\xBCller.der"] == "client 3");
    CHECK(contents["manifest.json"].starts_with(R"({"version":2,"controller":"press 4",)"));
    // As sha256sum says it of a file with "client a".
    CHECK(contains(contents["SHA256SUMS"],
                   "\n47ea62826f7f2d7e7460c8b099fb43715faedefab9a8d630a5e3a6a813f964a5  " +
                       a_place + "\n"));
    CHECK(contains(contents["SHA256SUMS"], "\n\\"));
    CHECK(contains(contents["SHA256SUMS"], R"(/back\\slash\nand line.der)"));

    MemoryFixture machine;
    REQUIRE(machine.memory.restore(backup, {}));
    CHECK(machine.files()["trusted/certs/back\\slash\nand line.der"] == "client 4");
    CHECK(machine.files()[long_name] == std::string(513, 'x'));
}

TEST_CASE("The same memory gives the same backup file (8-2-1)")
{
    CHECK(first_backup() == first_backup());
    // Times that no header of a tar can hold.
    for (const auto& [seconds, shown] :
         {std::pair{std::int64_t{-1}, "00000000000"}, {std::int64_t{1} << 34U, "77777777777"}}) {
        MemoryFixture machine;
        machine.put_all(test::first_machine());
        const BackupLabel strange{"press 4", DateTime::from_unix_seconds(seconds)};
        const auto made = machine.memory.backup(strange);
        REQUIRE(made);
        CHECK(TarBlocks{*made}.text(136, 12) == shown);
        CHECK(machine.memory.verify(*made, {}));
    }
}

TEST_CASE("A backup takes no more memory than the files three times (8-2-1)")
{
    MemoryFixture machine;
    machine.put_all(test::first_machine());
    const std::size_t size = 4U << 20U;
    machine.put("users.json", std::string(size, 'x'));
    const std::size_t before = test::held_bytes();
    test::forget_peak();
    const BackupBytes backup = machine.memory.backup(label).value();
    CHECK(test::peak_bytes() - before < 3 * size + 100'000);
    CHECK(backup.capacity() == backup.size());
}

TEST_CASE("Other tools may have written a backup file (8-2-2)")
{
    TarBlocks blocks = with_a();
    const std::size_t at = blocks.headers().back();
    std::size_t size = 0;
    SECTION("with an owner, rights and a time")
    {
        blocks.put(at + 100, "0000644");
        blocks.put(at + 108, "0001750");
        blocks.put(at + 136, "14000000000");
        blocks.put(at + 265, "operator");
    }
    SECTION("with a name in two parts")
    {
        blocks.put(at, std::string(100, '\0'));
        blocks.put(at, "certs/a.der");
        blocks.put(at + 345, "files/trusted");
    }
    SECTION("with more zeros at its end")
    {
        size = 10'240;
    }
    BackupBytes backup = blocks.sealed();
    backup.resize(std::max(size, backup.size()));
    MemoryFixture machine;
    CHECK(machine.memory.restore(backup, {}));
    CHECK(machine.files()[a_name] == "x");
}

TEST_CASE("A tar with something other than files is refused (8-2-2)")
{
    struct Row {
        const char* what;
        std::size_t at; // in the header
        std::string text;
        const char* found;
    };
    const std::vector<Row> rows{
        {"hard link", 156, "1", "a link"},
        {"link", 156, "2", "a link"},
        {"device", 156, "3", "a device"},
        {"folder", 156, "5", "a folder"},
        {"pipe", 156, "6", "a pipe"},
        {"long name of GNU", 156, "L", "an entry of type L"},
        {"global header", 156, "g", "an entry of type g"},
        {"type of old tars", 156, std::string(1, '\0'), "an entry of type"},
        {"extended header", 156, "x", "an extended header that is not a single path"},
        {"target", 157, "own/private/own.pem", "the target of a link"},
        {"no name", 0, std::string(100, '\0'), "a wrong name"},
        {"two names", 60, "own.pem", "a wrong name"},
        {"size of GNU", 124, "\x80", "a wrong name or size"},
        {"negative size", 124, "-0000000001", "a wrong name or size"},
        {"no digit", 124, "0000000000x", "a wrong name or size"},
        {"long size", 135, "1", "a wrong name or size"},
        {"beyond the end", 124, "77777777777", "its end within a file"},
        {"beyond the end by a block", 124, "00000002001", "its end within a file"},
        {"kind", 257, "ustar  ", "of another kind than ustar and pax"},
        {"after everything", 511, "x", "a wrong name"},
        {"padding", 512 + 511, "x", "bytes after the end of a file"},
    };
    for (const Row& row : rows) {
        INFO(row.what);
        TarBlocks blocks = with_a();
        blocks.put(blocks.headers().back() + row.at, row.text);
        const std::string refused = refusal(blocks.sealed());
        CHECK(refused.starts_with("backup: "));
        CHECK(contains(refused, row.found));
    }
}

TEST_CASE("A tar with a wrong end is refused (8-2-2)")
{
    const BackupBytes good = with_a().sealed();
    CHECK(refusal(good) == "restored");
    const auto with_size = [&](std::size_t size) {
        BackupBytes bad = good;
        bad.resize(size);
        return refusal(bad);
    };
    CHECK(contains(with_size(good.size() - 512), "no two blocks of zeros"));
    CHECK(contains(with_size(good.size() - 1'024), "its end within a file"));
    CHECK(contains(with_size(good.size() - 1'034), "its end within a file"));
    CHECK(contains(with_size(good.size() + 1), "no two blocks of zeros"));
    BackupBytes more = good;
    more.insert(more.end(), good.begin(), good.end());
    CHECK(contains(refusal(more), "no two blocks of zeros"));
}

TEST_CASE("An extended header has the path of a file and nothing else (8-2-2)")
{
    const auto refused_with = [](const std::string& record) {
        TarBlocks blocks{tar_of(
            {{"manifest.json", manifest({a_name})}, {extended_header, record}, {a_place, "x"}})};
        blocks.put(blocks.headers()[2] + 156, "x");
        return refusal(blocks.sealed());
    };
    CHECK(refused_with("34 path=files/trusted/certs/a.der\n") == "restored");
    for (const std::string record :
         {"", "\n", "=", "34 path=files/trusted/certs/a.deR", "33 path=files/trusted/certs/a.der\n",
          "034 path=files/trusted/certs/a.der\n", "34  path=files/trusted/certs/a.de\n",
          "16 size=1000000\n", "9 path=\n", "34 path=files/trusted/certs/a.der\n16 size=1000000\n",
          "16 size=1000000\n34 path=files/trusted/certs/a.der\n"}) {
        INFO(record);
        CHECK(contains(refused_with(record), "an extended header that is not a single path"));
    }
    CHECK(contains(refused_with("8212 path=" + std::string(8'201, 'x') + "\n"),
                   "an extended header that is not a single path"));
    TarBlocks last = with_a();
    last.put(last.headers().back() + 156, "x");
    last.put(last.headers().back() + 512, "9 path=x\n");
    last.put(last.headers().back() + 124, "00000000011");
    CHECK(contains(refusal(last.sealed()), "an extended header that no file follows"));
}

TEST_CASE("The files of a backup are those of its manifest (8-2-2)")
{
    const auto with = [](const Texts& named, const std::vector<NamedFile>& files) {
        std::vector<NamedFile> all{{"manifest.json", manifest(named)}};
        all.insert(all.end(), files.begin(), files.end());
        return refusal(tar_of(all));
    };
    const std::string b_name = "trusted/certs/b.der";
    CHECK(with({a_name}, {{a_place, "x"}}) == "restored");
    CHECK(contains(with({a_name}, {{"files/trusted/certs/../a.der", "x"}}),
                   "found files/trusted/certs/../a.der, expected " + a_place));
    CHECK(contains(with({a_name}, {{"/" + a_place, "x"}}), "expected " + a_place));
    CHECK(contains(with({"trusted/certs/../a.der"}, {{"files/trusted/certs/../a.der", "x"}}),
                   "without a valid name"));
    CHECK(contains(with({"/etc/passwd"}, {{"files//etc/passwd", "x"}}), "without a valid name"));
    CHECK(contains(with({a_name, a_name}, {{a_place, "x"}, {a_place, "x"}}), "of another one"));
    CHECK(contains(with({a_name}, {{a_place, "x"}, {a_place, "x"}}), "does not name"));
    CHECK(contains(with({a_name, b_name}, {{a_place, "x"}}), "found no more files"));
    CHECK(contains(with({a_name, b_name}, {{"files/" + b_name, "x"}, {a_place, "x"}}),
                   "expected " + a_place));
    CHECK(contains(with({a_name}, {{a_place, "xy"}}), "found 2 bytes of " + a_name));
    CHECK(contains(refusal(tar_of({{a_place, "x"}, {"manifest.json", manifest({a_name})}})),
                   "expected manifest.json"));
    CHECK(contains(refusal(tar_of({})), "found no more files, expected manifest.json"));

    const std::vector<NamedFile> many(5'000, {a_place, "x"});
    CHECK(contains(with({a_name}, many), "found more than 4096 files"));
}

TEST_CASE("A backup with another manifest is refused (8-2-3)")
{
    const auto with = [](const std::string& version) {
        return refusal(tar_of({{"manifest.json", manifest({a_name}, version)}, {a_place, "x"}}));
    };
    CHECK(with("") == "backup: found a manifest without version");
    CHECK(with(R"("version":"2",)") == "backup: found a manifest without version");
    CHECK(with(R"("version":3,)") == "backup: found version 3, expected 2");
    CHECK(contains(refusal(tar_of({{"manifest.json", "{"}})), "backup: the manifest: "));
}

TEST_CASE("A backup without the right checksums is refused (8-2-2)")
{
    const BackupBytes good = with_a().sealed();
    const auto with = [&](std::size_t at, std::string_view text) {
        TarBlocks bad{good};
        bad.put(512 + at, text);
        return refusal(bad.bytes());
    };
    CHECK(contains(with(0, "x"), "the checksum of manifest.json is not the one in SHA256SUMS"));
    CHECK(contains(with(64, " *"), "the checksum of manifest.json"));
    const std::size_t second = 64 + 2 + 13 + 1;
    CHECK(contains(with(second + 64 + 2 + a_place.size(), "\r"), "the checksum of " + a_place));
    TarBlocks damaged{good};
    damaged.put(damaged.headers().back() + 512, "y");
    CHECK(contains(refusal(damaged.bytes()), "the checksum of " + a_place));
    // One line too many, though the file lists what it has.
    TarWriter tar{0};
    const std::string sums = damaged.text(512, 400) + "\n";
    tar.add("SHA256SUMS", controller::detail::as_data(sums));
    CHECK(contains(refusal(tar.take()), "found checksums of files that are not there"));
}

// Backup files of version 1, as a controller wrote them before backups were tars.

TEST_CASE("An earlier backup is restored (8-2-3)")
{
    MemoryFixture machine;
    machine.put_all(test::second_machine());
    const BackupBytes whole = kept_file("whole.backup");
    CHECK(machine.memory.restore(whole, {}).value() == Restored::Data);
    MemoryFixture::Files expected = test::second_restored();
    expected["trusted/certs/M\xC3\xBCller [0A1B].der"] = "client 3";
    CHECK(machine.files() == expected);
    const auto verified = machine.memory.verify(whole, {});
    REQUIRE(verified);
    for (const VerifiedItem& item : *verified) {
        CHECK(item.differences.empty());
    }
    CHECK(machine.memory.restore(kept_file("without_profile.backup"), {}).value() ==
          Restored::WithoutProfile);
    CHECK(machine.memory.restore(kept_file("without_server.backup"), {}).value() ==
          Restored::Nothing);
}

TEST_CASE("An earlier backup that is cut, damaged or forged is refused (8-2-2)")
{
    const BackupBytes good = kept_file("whole.backup");
    MemoryFixture machine;
    machine.put_all(test::second_machine());
    const auto is_refused = [&](const BackupBytes& bad) {
        const bool is_done = machine.memory.restore(bad, {}).has_value();
        return !is_done && machine.files() == test::second_machine();
    };
    const test::Turns turns{"earlier backup", 7};
    for (std::size_t at = turns.first; at < good.size(); at += turns.stride) {
        REQUIRE(is_refused({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(at)}));
        BackupBytes bad = good;
        bad[at] ^= std::byte{0x10};
        REQUIRE(is_refused(bad));
    }
    const auto forged = [&](std::size_t at, std::byte byte) {
        BackupBytes bad{good.begin(), good.end() - 4};
        bad[at] = byte;
        return refusal(test::sealed_earlier(bad));
    };
    CHECK(forged(8, std::byte{2}) == "backup: found version 2, expected 1");
    CHECK(contains(forged(14, std::byte{1}), "a manifest larger than the file"));
    BackupBytes more{good.begin(), good.end() - 4};
    more.push_back(std::byte{0});
    CHECK(contains(refusal(test::sealed_earlier(more)), "found 1 bytes more"));
}

} // namespace backup_tar_test
