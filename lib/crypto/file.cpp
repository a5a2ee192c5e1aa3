#include <busbar/crypto/file.hpp>

#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace busbar::crypto {

namespace {

/// An open file; -1 if it could not be opened.
class Descriptor {
public:
    explicit Descriptor(int value) : value_{value} {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor()
    {
        if (value_ >= 0) {
            ::close(value_);
        }
    }

    [[nodiscard]] int get() const { return value_; }
    [[nodiscard]] bool is_open() const { return value_ >= 0; }

private:
    int value_;
};

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

bool write_new_file(const std::string& path, std::span<const std::byte> bytes, FileAccess access)
{
    const mode_t mode = access == FileAccess::Owner ? 0600 : 0644;
    // O_EXCL: neither a link nor a file with other rights that lies there is written through.
    const Descriptor file{
        ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode)};
    return file.is_open() && write_all(file.get(), bytes) && ::fsync(file.get()) == 0;
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

} // namespace

Result<void> save_file(const std::string& path, std::span<const std::byte> bytes, FileAccess access)
{
    const std::string temporary = path + ".new";
    ::unlink(temporary.c_str()); // what a power cut may have left
    if (!write_new_file(temporary, bytes, access) ||
        std::rename(temporary.c_str(), path.c_str()) != 0) {
        ::unlink(temporary.c_str());
        return fail(status::Bad_ResourceUnavailable);
    }
    sync_folder_of(path);
    return {};
}

} // namespace busbar::crypto
