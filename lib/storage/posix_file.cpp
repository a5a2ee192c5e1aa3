#include "posix_file.hpp"

#include <cerrno>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace busbar::storage::detail {

namespace {

constexpr std::string_view unfinished = ".busbar-new";
/// Maximum number of writers of one file that are active, or died, at the same time.
constexpr int max_writers = 100;
constexpr std::uint64_t max_copied_size = 256U << 20U;

mode_t mode_of(FileAccess access)
{
    return access == FileAccess::Owner ? 0600 : 0644;
}

bool write_all(int file, std::span<const std::byte> bytes)
{
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return true;
}

/// The writer of an unfinished file holds a lock on it. On a medium without locks no file is
/// locked.
bool is_locked(int file)
{
    return ::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

/// Locks a file that was just created. Returns false if it was taken for a dead writer's, and
/// removed, before.
bool lock_new(int file)
{
    struct stat facts = {};
    return !is_locked(file) && ::fstat(file, &facts) == 0 && facts.st_nlink != 0;
}

/// Creates a new file next to `path` and stores its name in `name`. No other writer has the same
/// name, in this process or another, even if a process in another container has the same number.
int open_temporary(const std::string& path, FileAccess access, std::string& name)
{
    for (int i = 0; i < max_writers; ++i) {
        name = path + "." + std::to_string(::getpid()) + "-" + std::to_string(i);
        name += unfinished;
        // O_EXCL: never write through an existing link or a file with other rights.
        const int file = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                                mode_of(access));
        if (file < 0 ? errno != EEXIST : lock_new(file)) {
            return file;
        }
        if (file >= 0) {
            ::close(file);
        }
    }
    return -1;
}

/// Moves to another disk, where a rename is impossible: both have the file for a moment.
Stored<void> copy_and_remove(const std::string& from, const std::string& to)
{
    const Descriptor file{::open(from.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0) {
        return not_stored(last_error());
    }
    if (!S_ISREG(facts.st_mode) || static_cast<std::uint64_t>(facts.st_size) > max_copied_size) {
        return not_stored(StorageError::TooLarge);
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(facts.st_size));
    const auto count = read_from(file.get(), 0, bytes);
    if (!count || *count != bytes.size()) {
        return not_stored(count ? StorageError::Failed : count.error());
    }
    const FileAccess access =
        (facts.st_mode & (S_IRWXG | S_IRWXO)) == 0 ? FileAccess::Owner : FileAccess::Everyone;
    if (auto saved = save(to, bytes, access); !saved) {
        return saved;
    }
    if (::unlink(from.c_str()) != 0) {
        return not_stored(last_error());
    }
    sync_folder_of(from);
    return {};
}

} // namespace

StorageError last_error()
{
    switch (errno) {
    case ENOENT:
    case ENOTDIR:
        return StorageError::NotFound;
    case EEXIST:
    case ENOTEMPTY:
        return StorageError::Exists;
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
        return StorageError::Full;
    case EROFS:
    case EACCES:
    case EPERM:
        return StorageError::Protected;
    case ENODEV:
    case ENXIO:
    case ESTALE:
        return StorageError::Away;
    case ENAMETOOLONG:
        return StorageError::BadName;
    default:
        return StorageError::Failed;
    }
}

bool is_unfinished(std::string_view name)
{
    return name.size() > unfinished.size() &&
           name.substr(name.size() - unfinished.size()) == unfinished;
}

void remove_dead(const std::string& path)
{
    const Descriptor file{::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    if (!file.is_open() || !is_locked(file.get())) {
        ::unlink(path.c_str());
    }
}

void sync_folder_of(const std::string& path)
{
    const std::size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
    const Descriptor file{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (file.is_open()) {
        ::fsync(file.get());
    }
}

Stored<void> save(const std::string& path, std::span<const std::byte> bytes, FileAccess access)
{
    std::string temporary;
    const Descriptor file{open_temporary(path, access, temporary)};
    if (!file.is_open()) {
        return not_stored(last_error());
    }
    // A file that is not on the disk before it gets its name may be incomplete after a power
    // failure.
    if (!write_all(file.get(), bytes) || ::fsync(file.get()) != 0 ||
        ::rename(temporary.c_str(), path.c_str()) != 0) {
        const StorageError error = last_error();
        ::unlink(temporary.c_str());
        return not_stored(error);
    }
    sync_folder_of(path);
    return {};
}

Stored<void> append(const std::string& path, std::span<const std::byte> bytes, FileAccess access,
                    Durability durability)
{
    constexpr int flags = O_WRONLY | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    Descriptor present{::open(path.c_str(), flags)};
    const bool is_new = !present.is_open() && errno == ENOENT;
    const Descriptor file{is_new ? ::open(path.c_str(), flags | O_CREAT | O_EXCL, mode_of(access))
                                 : present.release()};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0) {
        return not_stored(last_error());
    }
    if (!S_ISREG(facts.st_mode)) {
        return not_stored(StorageError::Failed);
    }
    const bool is_synced = durability == Durability::PowerCut;
    if (!write_all(file.get(), bytes) || (is_synced && ::fsync(file.get()) != 0)) {
        return not_stored(last_error());
    }
    if (is_new && is_synced) {
        sync_folder_of(path);
    }
    return {};
}

Stored<void> sync(const std::string& path)
{
    const Descriptor file{::open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    if (!file.is_open() || ::fsync(file.get()) != 0) {
        return not_stored(last_error());
    }
    sync_folder_of(path); // the file may be new
    return {};
}

Stored<void> rename_durably(const std::string& from, const std::string& to)
{
    if (::rename(from.c_str(), to.c_str()) == 0) {
        // Add the new name first, then remove the old one.
        sync_folder_of(to);
        sync_folder_of(from);
        return {};
    }
    return errno == EXDEV ? copy_and_remove(from, to) : Stored<void>{not_stored(last_error())};
}

Stored<std::size_t> read_from(int file, std::uint64_t offset, std::span<std::byte> into)
{
    std::size_t count = 0;
    while (count < into.size()) {
        const ssize_t size = ::pread(file, into.data() + count, into.size() - count,
                                     static_cast<off_t>(offset + count));
        if (size < 0 && errno == EINTR) {
            continue;
        }
        if (size < 0) {
            return not_stored(last_error());
        }
        if (size == 0) {
            break;
        }
        count += static_cast<std::size_t>(size);
    }
    return count;
}

} // namespace busbar::storage::detail
