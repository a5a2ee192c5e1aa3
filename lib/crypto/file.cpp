#include <busbar/crypto/file.hpp>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "descriptor.hpp"

namespace busbar::crypto {

namespace {

using detail::Descriptor;

constexpr std::string_view unfinished = ".busbar-new";
/// Writers of one file that are at work, or died, at the same time.
constexpr int max_writers = 100;
constexpr std::size_t max_copied_size = 64U << 20U;

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

/// A new file beside `path`, its name in `name`. No other writer has the same, in this process or
/// another; which also may be one of the same number in another container.
int open_temporary(const std::string& path, FileAccess access, std::string& name)
{
    const mode_t mode = access == FileAccess::Owner ? 0600 : 0644;
    for (int i = 0; i < max_writers; ++i) {
        name = path + "." + std::to_string(::getpid()) + "-" + std::to_string(i);
        name += unfinished;
        // O_EXCL: neither a link nor a file with other rights that lies there is written through.
        const int file =
            ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
        if (file >= 0 || errno != EEXIST) {
            return file;
        }
    }
    return -1;
}

/// A new name is on the disk only when its folder is.
void sync_folder_of(const std::string& path)
{
    const std::size_t slash = path.rfind('/');
    const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
    const Descriptor file{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (file.is_open()) {
        ::fsync(file.get());
    }
}

bool exists(const std::string& path)
{
    struct stat facts = {};
    return ::lstat(path.c_str(), &facts) == 0;
}

/// On another disk a name cannot be given: both have it for a moment.
Result<void> copy_and_remove(const std::string& from, const std::string& to)
{
    const Descriptor file{::open(from.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0 || !S_ISREG(facts.st_mode)) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const auto bytes = detail::read_rest(file.get(), max_copied_size);
    if (!bytes) {
        return fail(status::Bad_ResourceUnavailable);
    }
    const FileAccess access =
        (facts.st_mode & (S_IRWXG | S_IRWXO)) == 0 ? FileAccess::Owner : FileAccess::Everyone;
    const auto saved = save_file(to, *bytes, access);
    return saved ? remove_file(from) : saved;
}

} // namespace

Result<void> save_file(const std::string& path, std::span<const std::byte> bytes, FileAccess access)
{
    std::string temporary;
    const Descriptor file{open_temporary(path, access, temporary)};
    if (!file.is_open()) {
        return fail(status::Bad_ResourceUnavailable);
    }
    // What is not on the disk before it gets its name may be half a file after a power cut.
    if (!write_all(file.get(), bytes) || ::fsync(file.get()) != 0 ||
        ::rename(temporary.c_str(), path.c_str()) != 0) {
        ::unlink(temporary.c_str());
        return fail(status::Bad_ResourceUnavailable);
    }
    sync_folder_of(path);
    return {};
}

Result<void> move_file(const std::string& from, const std::string& to)
{
    if (exists(to)) {
        return fail(status::Bad_EntryExists);
    }
    if (::rename(from.c_str(), to.c_str()) == 0) {
        // First the new name, then the missing old one.
        sync_folder_of(to);
        sync_folder_of(from);
        return {};
    }
    return errno == EXDEV ? copy_and_remove(from, to) : fail(status::Bad_ResourceUnavailable);
}

Result<void> remove_file(const std::string& path)
{
    if (::unlink(path.c_str()) != 0) {
        return fail(status::Bad_ResourceUnavailable);
    }
    sync_folder_of(path);
    return {};
}

bool is_unfinished_file(std::string_view name)
{
    return name.size() > unfinished.size() &&
           name.substr(name.size() - unfinished.size()) == unfinished;
}

void remove_unfinished_files(const std::string& folder)
{
    DIR* names = ::opendir(folder.c_str());
    if (names == nullptr) {
        return;
    }
    std::vector<std::string> found;
    while (const dirent* entry = ::readdir(names)) {
        if (is_unfinished_file(entry->d_name)) {
            found.push_back(folder + "/" + entry->d_name);
        }
    }
    ::closedir(names);
    for (const std::string& path : found) {
        ::unlink(path.c_str());
    }
}

} // namespace busbar::crypto
