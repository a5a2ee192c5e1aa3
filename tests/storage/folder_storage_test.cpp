#include <busbar/storage/folder_storage.hpp>

#include <filesystem>
#include <fstream>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/unfinished.hpp"

#include "media.hpp"

namespace folder_storage_test {

using namespace busbar;
using namespace busbar::test;
using storage::FolderStorage;
namespace fs = std::filesystem;

namespace {

unsigned mode_of(const fs::path& file)
{
    struct ::stat facts = {};
    REQUIRE(::lstat(file.c_str(), &facts) == 0);
    return static_cast<unsigned>(facts.st_mode) & 07777U;
}

std::string text_in(const fs::path& file)
{
    std::ifstream stream{file, std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

} // namespace

TEST_CASE("folder storage: only the owner may read what is for the owner")
{
    const TemporaryFolder folder;
    FolderStorage files{folder.path.string()};
    const ::mode_t before = ::umask(0);
    REQUIRE(put(files, "open", "1"));
    REQUIRE(files.replace("closed", bytes_of("1"), FileAccess::Owner));
    REQUIRE(files.append("log", bytes_of("1"), FileAccess::Owner));
    REQUIRE(files.make_folder("keys", FileAccess::Owner));
    REQUIRE(files.make_folder("a/b", FileAccess::Owner));
    CHECK(mode_of(folder.path / "open") == 0644);
    CHECK(mode_of(folder.path / "closed") == 0600);
    CHECK(mode_of(folder.path / "log") == 0600);
    CHECK(mode_of(folder.path / "keys") == 0700);
    CHECK(mode_of(folder.path / "a") == 0755);
    CHECK(mode_of(folder.path / "a/b") == 0700);
    // Also where a file that everybody may read was before.
    REQUIRE(files.replace("open", bytes_of("2"), FileAccess::Owner));
    CHECK(mode_of(folder.path / "open") == 0600);
    fs::permissions(folder.path / "keys", fs::perms{0755});
    CHECK(files.close_to_others("keys") == true);
    CHECK(mode_of(folder.path / "keys") == 0700);
    ::umask(before);
}

TEST_CASE("folder storage: links are not written through, and their files are read")
{
    const TemporaryFolder folder;
    FolderStorage files{folder.path.string()};
    const fs::path victim = folder.path / "victim";
    REQUIRE(put(files, "victim", "untouched"));
    // Where the new file is written, and where it goes.
    fs::create_symlink(victim, folder.path / ("a." + std::to_string(::getpid()) + "-0.busbar-new"));
    fs::create_symlink(victim, folder.path / "a");
    CHECK(read(files, "a") == "untouched");
    CHECK(read_file(files, "a", 3).error() == StorageError::TooLarge);
    CHECK(files.entry("a")->kind == StorageEntry::Kind::Other);
    CHECK_FALSE(add(files, "a", "more"));
    REQUIRE(put(files, "a", "second"));
    CHECK(text_in(folder.path / "a") == "second");
    CHECK(text_in(victim) == "untouched");
    CHECK(files.entry("a")->kind == StorageEntry::Kind::File);
}

TEST_CASE("folder storage: what is no file is neither read nor waited for")
{
    const TemporaryFolder folder;
    FolderStorage files{folder.path.string()};
    REQUIRE(::mkfifo((folder.path / "pipe").c_str(), 0600) == 0);
    CHECK(files.entry("pipe")->kind == StorageEntry::Kind::Other);
    CHECK(read_file(files, "pipe", 9).error() == StorageError::Failed);
    CHECK_FALSE(add(files, "pipe", "x"));
    fs::create_symlink("/dev/zero", folder.path / "endless");
    CHECK(read_file(files, "endless", 9).error() == StorageError::Failed);
    CHECK(files.read("", 0, {}).error() == StorageError::BadName);
}

TEST_CASE("folder storage: what a writer that died left is not seen, and goes")
{
    const TemporaryFolder folder;
    FolderStorage files{folder.path.string()};
    std::ofstream{folder.path / "a.77-0.busbar-new"} << "half";
    CHECK(names(files, "").empty());
    CHECK(files.entry("a.77-0.busbar-new").error() == StorageError::BadName);
    CHECK_FALSE(put(files, "a.77-0.busbar-new", "x"));
    files.remove_unfinished("");
    CHECK(fs::is_empty(folder.path));
}

TEST_CASE("folder storage: what a writer is about to write stays")
{
    const TemporaryFolder folder;
    FolderStorage files{folder.path.string()};
    const fs::path name = folder.path / "a.77-0.busbar-new";
    const int writer = ::open(name.c_str(), O_WRONLY | O_CREAT, 0600);
    REQUIRE(::flock(writer, LOCK_EX) == 0);
    files.remove_unfinished("");
    CHECK(fs::exists(name));
    ::close(writer);
    files.remove_unfinished("");
    CHECK_FALSE(fs::exists(name));
    CHECK(put(files, "a", "x"));
}

TEST_CASE(
    "folder storage: what writers left goes in all folders, and is not followed through links")
{
    const TemporaryFolder folder;
    const TemporaryFolder other;
    FolderStorage files{folder.path.string()};
    REQUIRE(files.make_folder("a/b", FileAccess::Owner));
    fs::create_directory_symlink(other.path, folder.path / "link");
    const auto leave = [](const fs::path& in) {
        std::ofstream{in / "a.77-0.busbar-new"} << "half";
    };
    for (const fs::path& in : {folder.path, folder.path / "a", folder.path / "a/b", other.path}) {
        leave(in);
    }
    busbar::detail::remove_unfinished_below(files, "");
    CHECK(fs::is_empty(folder.path / "a/b"));
    CHECK_FALSE(fs::exists(folder.path / "a/a.77-0.busbar-new"));
    CHECK_FALSE(fs::exists(folder.path / "a.77-0.busbar-new"));
    CHECK(fs::exists(other.path / "a.77-0.busbar-new"));
}

TEST_CASE("folder storage: a root that is gone is away")
{
    const TemporaryFolder folder;
    FolderStorage files{(folder.path / "deep/root/").string()};
    CHECK(files.place("a") == (folder.path / "deep/root/a").string());
    CHECK(files.place("") == (folder.path / "deep/root").string());
    CHECK(read_file(files, "a", 9).error() == StorageError::Away);
    CHECK(put(files, "a", "x").error() == StorageError::Away);
    CHECK(files.list("", 9).error() == StorageError::Away);
    CHECK(files.free_space().error() == StorageError::Away);
    REQUIRE(files.make_folder("", FileAccess::Everyone));
    CHECK(read_file(files, "a", 9).error() == StorageError::NotFound);
    REQUIRE(put(files, "a", "x"));
    CHECK(*files.free_space() > 0);
    CHECK(FolderStorage{""}.place("a") == "./a");
    CHECK(FolderStorage{"/"}.place("a") == "/a");
}

TEST_CASE("folder storage: a medium that is gone is not made by what would be written to it")
{
    const TemporaryFolder folder;
    const auto root = folder.path / "card";
    FolderStorage card{root.string(), FolderStorage::Root::Medium};
    CHECK(card.make_folder("log", FileAccess::Owner).error() == StorageError::Away);
    CHECK(card.make_folder("log/old", FileAccess::Owner).error() == StorageError::Away);
    CHECK_FALSE(fs::exists(root));
    REQUIRE(card.make_folder("", FileAccess::Owner));
    REQUIRE(card.make_folder("log/old", FileAccess::Owner));
    REQUIRE(put(card, "log/old/a", "x"));
    fs::rename(root, folder.path / "pulled");
    CHECK(card.make_folder("log/old", FileAccess::Owner).error() == StorageError::Away);
    CHECK(card.append("log/old/a", {}, FileAccess::Owner).error() == StorageError::Away);
    CHECK_FALSE(fs::exists(root));
    fs::rename(folder.path / "pulled", root);
    CHECK(names(card, "log/old") == std::vector<std::string>{"a"});

    // Others are made with what is in them.
    FolderStorage made{(folder.path / "made").string()};
    CHECK(made.make_folder("log", FileAccess::Owner));
}

TEST_CASE("folder storage: the times of a file are those of the system")
{
    const TemporaryFolder folder;
    FolderStorage files{folder.path.string()};
    REQUIRE(put(files, "a", "x"));
    fs::last_write_time(folder.path / "a",
                        fs::file_time_type::clock::now() - std::chrono::hours{9});
    const auto entry = files.entry("a");
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now).count();
    // Changed hours ago by its own account, touched just now.
    CHECK(std::abs(entry->modified.unix_seconds() - (seconds - 9 * 3'600)) < 600);
    CHECK(std::abs(entry->touched.unix_seconds() - seconds) < 600);
}

} // namespace folder_storage_test
