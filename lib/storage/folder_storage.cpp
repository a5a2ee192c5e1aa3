#include <busbar/storage/folder_storage.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include "names.hpp"
#include "posix_file.hpp"

namespace busbar::storage {

namespace {

using detail::Descriptor;
using detail::is_folder_name;
using detail::last_error;
using detail::last_part;

constexpr mode_t others = S_IRWXG | S_IRWXO;

bool is_file_name(std::string_view name)
{
    return is_storage_name(name) && !detail::is_unfinished(last_part(name));
}

DateTime time_of(const timespec& time)
{
    return DateTime::from_unix_ticks(time.tv_sec * DateTime::ticks_per_second + time.tv_nsec / 100);
}

std::uint64_t nanoseconds_of(const timespec& time)
{
    return static_cast<std::uint64_t>(time.tv_sec) * 1'000'000'000U +
           static_cast<std::uint64_t>(time.tv_nsec);
}

StorageEntry entry_of(std::string_view name, const struct stat& facts)
{
    StorageEntry entry;
    entry.name = name;
    entry.kind = S_ISREG(facts.st_mode)   ? StorageEntry::Kind::File
                 : S_ISDIR(facts.st_mode) ? StorageEntry::Kind::Folder
                                          : StorageEntry::Kind::Other;
    entry.size = static_cast<std::uint64_t>(facts.st_size);
    entry.modified = time_of(facts.st_mtim);
    entry.touched = std::max(entry.modified, time_of(facts.st_ctim));
    entry.version = {
        {facts.st_dev, facts.st_ino, nanoseconds_of(facts.st_mtim), nanoseconds_of(facts.st_ctim)}};
    return entry;
}

/// An open folder for reading, closed at the end.
class Names {
public:
    explicit Names(const std::string& path) : stream_{::opendir(path.c_str())} {}
    Names(const Names&) = delete;
    Names& operator=(const Names&) = delete;
    ~Names()
    {
        if (stream_ != nullptr) {
            ::closedir(stream_);
        }
    }

    [[nodiscard]] bool is_open() const { return stream_ != nullptr; }
    [[nodiscard]] int descriptor() const { return ::dirfd(stream_); }
    /// Returns the next name; empty at the end. "." and ".." are left out.
    [[nodiscard]] std::string_view next()
    {
        while (const dirent* entry = ::readdir(stream_)) {
            const std::string_view name{entry->d_name};
            if (name != "." && name != "..") {
                return name;
            }
        }
        return {};
    }

private:
    DIR* stream_;
};

/// Creates one folder, not its parents. Durable, as files are: the contents of a folder are lost if
/// the folder's own name is.
Stored<void> make_one_folder(const std::string& path, FileAccess access)
{
    if (::mkdir(path.c_str(), access == FileAccess::Owner ? 0700 : 0755) == 0) {
        detail::sync_folder_of(path);
        return {};
    }
    const StorageError error = last_error();
    struct stat facts = {};
    if (::stat(path.c_str(), &facts) == 0) {
        return S_ISDIR(facts.st_mode) ? Stored<void>{} : not_stored(StorageError::Failed);
    }
    return not_stored(error);
}

} // namespace

FolderStorage::FolderStorage(std::string folder, Root root) : root_{std::move(folder)}, kind_{root}
{
    while (root_.size() > 1 && root_.back() == '/') {
        root_.pop_back();
    }
    if (root_.empty()) {
        root_ = ".";
    }
}

std::string FolderStorage::place(std::string_view name) const
{
    if (name.empty()) {
        return root_;
    }
    return root_ == "/" ? root_ + std::string{name} : storage_path(root_, name);
}

StorageError FolderStorage::checked(StorageError error) const
{
    struct stat facts = {};
    return error == StorageError::NotFound && ::stat(root_.c_str(), &facts) != 0
               ? StorageError::Away
               : error;
}

Stored<StorageEntry> FolderStorage::entry(std::string_view name)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    struct stat facts = {};
    if (::lstat(place(name).c_str(), &facts) != 0) {
        return not_stored(checked(last_error()));
    }
    return entry_of(last_part(name), facts);
}

Stored<std::size_t> FolderStorage::read(std::string_view name, std::uint64_t offset,
                                        std::span<std::byte> into)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    // O_NONBLOCK: opening does not wait, whatever kind of file it is.
    const Descriptor file{::open(place(name).c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0) {
        return not_stored(checked(last_error()));
    }
    if (!S_ISREG(facts.st_mode)) {
        return not_stored(StorageError::Failed);
    }
    if (offset > static_cast<std::uint64_t>(INT64_MAX) - into.size()) {
        return 0U;
    }
    return detail::read_from(file.get(), offset, into);
}

Stored<void> FolderStorage::replace(std::string_view name, std::span<const std::byte> bytes,
                                    FileAccess access)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const auto saved = detail::save(place(name), bytes, access);
    return saved ? saved : not_stored(checked(saved.error()));
}

Stored<void> FolderStorage::append(std::string_view name, std::span<const std::byte> bytes,
                                   FileAccess access)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const auto added = detail::append(place(name), bytes, access, detail::Durability::PowerCut);
    return added ? added : not_stored(checked(added.error()));
}

Stored<void> FolderStorage::append_unsynced(std::string_view name, std::span<const std::byte> bytes,
                                            FileAccess access)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const auto added = detail::append(place(name), bytes, access, detail::Durability::ProgramEnd);
    return added ? added : not_stored(checked(added.error()));
}

Stored<void> FolderStorage::sync(std::string_view name)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const auto synced = detail::sync(place(name));
    return synced ? synced : not_stored(checked(synced.error()));
}

Stored<void> FolderStorage::move(std::string_view from, std::string_view to, WhenThere when_there)
{
    if (!is_file_name(from) || !is_file_name(to)) {
        return not_stored(StorageError::BadName);
    }
    const std::string target = place(to);
    struct stat facts = {};
    if (when_there == WhenThere::Refuse && ::lstat(target.c_str(), &facts) == 0) {
        return not_stored(StorageError::Exists);
    }
    const auto moved = detail::rename_durably(place(from), target);
    return moved ? moved : not_stored(checked(moved.error()));
}

Stored<void> FolderStorage::remove(std::string_view name)
{
    if (!is_file_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const std::string path = place(name);
    struct stat facts = {};
    const bool is_folder = ::lstat(path.c_str(), &facts) == 0 && S_ISDIR(facts.st_mode);
    if ((is_folder ? ::rmdir(path.c_str()) : ::unlink(path.c_str())) != 0) {
        return not_stored(checked(last_error()));
    }
    detail::sync_folder_of(path);
    return {};
}

Stored<StorageListing> FolderStorage::list(std::string_view folder, std::size_t most)
{
    if (!is_folder_name(folder)) {
        return not_stored(StorageError::BadName);
    }
    Names names{place(folder)};
    if (!names.is_open()) {
        return not_stored(checked(last_error()));
    }
    StorageListing listing;
    for (std::string_view name = names.next(); !name.empty(); name = names.next()) {
        struct stat facts = {};
        // A file that was removed meanwhile is not listed.
        if (detail::is_unfinished(name) || ::fstatat(names.descriptor(), std::string{name}.c_str(),
                                                     &facts, AT_SYMLINK_NOFOLLOW) != 0) {
            continue;
        }
        if (listing.entries.size() == most) {
            listing.is_cut = true;
            break;
        }
        listing.entries.push_back(entry_of(name, facts));
    }
    std::sort(listing.entries.begin(), listing.entries.end(),
              [](const StorageEntry& a, const StorageEntry& b) { return a.name < b.name; });
    return listing;
}

Stored<void> FolderStorage::make_folder(std::string_view name, FileAccess access)
{
    if (!is_folder_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const std::string path = place(name);
    const bool has_root = kind_ == Root::Medium && !name.empty();
    const std::size_t begin = has_root ? root_.size() + 1 : 1;
    for (std::size_t at = path.find('/', begin); at != std::string::npos;
         at = path.find('/', at + 1)) {
        if (const auto made = make_one_folder(path.substr(0, at), FileAccess::Everyone); !made) {
            return not_stored(checked(made.error()));
        }
    }
    const auto made = make_one_folder(path, access);
    return made ? made : not_stored(checked(made.error()));
}

Stored<bool> FolderStorage::close_to_others(std::string_view name)
{
    if (!is_folder_name(name)) {
        return not_stored(StorageError::BadName);
    }
    const Descriptor file{
        ::open(place(name).c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0) {
        return not_stored(checked(last_error()));
    }
    if ((facts.st_mode & others) == 0) {
        return false;
    }
    if (::fchmod(file.get(), facts.st_mode & static_cast<mode_t>(S_IRWXU)) != 0) {
        return not_stored(last_error());
    }
    return true;
}

void FolderStorage::remove_unfinished(std::string_view folder)
{
    std::vector<std::string> found;
    {
        Names names{place(folder)};
        for (std::string_view name = names.is_open() ? names.next() : ""; !name.empty();
             name = names.next()) {
            if (detail::is_unfinished(name)) {
                found.push_back(place(storage_path(folder, name)));
            }
        }
    }
    for (const std::string& path : found) {
        detail::remove_dead(path);
    }
}

Stored<std::uint64_t> FolderStorage::free_space()
{
    struct statvfs facts = {};
    if (::statvfs(root_.c_str(), &facts) != 0) {
        return not_stored(checked(last_error()));
    }
    return static_cast<std::uint64_t>(facts.f_bavail) * facts.f_frsize;
}

} // namespace busbar::storage
