#include <algorithm>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/backup.hpp>
#include <busbar/storage/memory_storage.hpp>
#include <controller/backup/sealed_backup.hpp>

namespace backup_fuzz {

using namespace busbar;
using namespace busbar::controller;

namespace {

using Contents = std::map<std::string, std::vector<std::byte>>;

/// The lines of a file that begin with "p", or the others.
FilePart lines_part(bool is_of_profile)
{
    const auto take = [=](std::span<const std::byte> whole, bool is_mine) {
        FilePart::Bytes kept;
        while (!whole.empty()) {
            const auto end = std::find(whole.begin(), whole.end(), std::byte{'\n'});
            const auto size = static_cast<std::size_t>(end - whole.begin());
            const auto line = whole.first(std::min(size + 1, whole.size()));
            if ((line.front() == std::byte{'p'}) == (is_of_profile == is_mine)) {
                kept.insert(kept.end(), line.begin(), line.begin() + static_cast<int>(size));
                kept.push_back(std::byte{'\n'});
            }
            whole = whole.subspan(line.size());
        }
        return kept;
    };
    return {.file = "options",
            .take = [=](auto whole) -> Configured<FilePart::Bytes> { return take(whole, true); },
            .put = [=](auto whole, auto part) -> Configured<FilePart::Bytes> {
                FilePart::Bytes joined = take(whole, false);
                const FilePart::Bytes own = take(part, true);
                joined.insert(joined.end(), own.begin(), own.end());
                return joined;
            }};
}

std::vector<MemoryItem> fuzzed_items()
{
    const auto check = [](std::string_view name, std::span<const std::byte> bytes) {
        const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        return read_server_settings(text, std::string{name}).transform([](const auto&) {});
    };
    return {MemoryItem{.name = "Settings",
                       .files = {"server.json"},
                       .initial = {{"server.json", document_of(ServerSettings{})}},
                       .check = check},
            MemoryItem{
                .name = "Certificate", .group = MemoryGroup::ServerCertificate, .folders = {"own"}},
            MemoryItem{.name = "Clients",
                       .group = MemoryGroup::SecurityProfile,
                       .files = {"users.json"},
                       .folders = {"trusted"},
                       .access = FileAccess::Everyone},
            MemoryItem{.name = "Options", .files = {"options"}, .part = lines_part(false)},
            MemoryItem{.name = "Login",
                       .group = MemoryGroup::SecurityProfile,
                       .files = {"login"},
                       .part = lines_part(true)},
            MemoryItem{.name = "Events", .group = MemoryGroup::EventLog, .files = {"events"}}};
}

Contents contents(storage::MemoryStorage& storage)
{
    Contents all;
    for (const std::string& name : storage.names()) {
        if (auto bytes = read_file(storage, name, 1U << 26U)) {
            all[name] = *std::move(bytes);
        }
    }
    return all;
}

void fill(storage::MemoryStorage& storage)
{
    const std::string content = "x";
    for (const char* folder : {"own", "trusted"}) {
        static_cast<void>(storage.make_folder(folder, FileAccess::Owner));
    }
    for (const char* name :
         {"own/key", "trusted/a", "trusted/b", "users.json", "events", "execution", "options"}) {
        static_cast<void>(
            storage.replace(name, std::as_bytes(std::span{content}), FileAccess::Owner));
    }
}

void expect(bool holds)
{
    if (!holds) {
        __builtin_trap();
    }
}

/// With the right checksums, so that what comes after them is reached.
std::vector<std::byte> sealed(std::span<const std::byte> bytes)
{
    const std::string_view text{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    return text.starts_with("BUSBARBK") ? test::sealed_earlier(bytes)
                                        : test::TarBlocks{{bytes.begin(), bytes.end()}}.sealed();
}

/// A restore that is to leave the security profile leaves it.
void keep_the_profile(std::span<const std::byte> backup)
{
    NullLog log;
    storage::MemoryStorage storage;
    fill(storage);
    const std::string options = "server\nprofile\n";
    static_cast<void>(
        storage.replace("options", std::as_bytes(std::span{options}), FileAccess::Owner));
    MachineMemory memory{storage, "restore", fuzzed_items(), log};
    const Contents before = contents(storage);
    const auto restored = memory.restore(backup, {.security_profile = false});
    if (!restored || *restored == Restored::Nothing) {
        return;
    }
    const Contents after = contents(storage);
    for (const char* kept : {"trusted/a", "trusted/b", "users.json", "own/key"}) {
        expect(after.at(kept) == before.at(kept));
    }
    const std::vector<std::byte>& now = after.at("options");
    const std::string text =
        "\n" + std::string{reinterpret_cast<const char*>(now.data()), now.size()};
    const std::size_t line = text.find("\np");
    expect(line != std::string::npos && text.compare(line, 9, "\nprofile\n") == 0);
    expect(text.find("\np", line + 1) == std::string::npos);
}

} // namespace

/// A backup file of any origin, a tar or one of version 1 without its checksum: it is restored
/// whole, and only where it may be, or changes nothing. The next backup has what was restored. The
/// same bytes as a RestoreCommand.ini and as a file of settings.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    const auto bytes = std::as_bytes(std::span{data, size});
    const std::string_view text{reinterpret_cast<const char*>(data), size};
    static_cast<void>(read_restore_command(text));
    if (const auto settings = read_server_settings(text, "fuzzed")) {
        const auto again = read_server_settings(document_of(*settings), "written");
        expect(again && *again == *settings);
    }
    static_cast<void>(read_security_settings(text, "fuzzed"));

    NullLog log;
    storage::MemoryStorage storage;
    fill(storage);
    MachineMemory memory{storage, "restore", fuzzed_items(), log};
    const Contents before = contents(storage);
    const auto backup = sealed(bytes);
    static_cast<void>(memory.verify(bytes, {}));
    keep_the_profile(backup);
    const auto restored = memory.restore(backup, {});
    const Contents after = contents(storage);
    if (!restored) {
        expect(after == before);
        return 0;
    }
    for (const char* kept : {"events", "execution"}) {
        expect(after.at(kept) == before.at(kept));
    }
    expect(after.count("own/key") == (*restored == Restored::Nothing ? 0 : 1));
    const auto verified = memory.verify(backup, {});
    expect(verified.has_value() == (*restored != Restored::Nothing));
    if (verified) {
        for (const VerifiedItem& item : *verified) {
            // What a new controller has comes in the place of what a backup has not.
            expect(item.differences.empty() ||
                   item.differences == std::vector<std::string>{"server.json"});
        }
    }
    const auto next = memory.backup({});
    expect(next && *next == memory.backup({}));
    const auto same = memory.verify(*next, {});
    expect(same.has_value());
    for (const VerifiedItem& item : *same) {
        expect(item.differences.empty());
    }
    return 0;
}

} // namespace backup_fuzz
