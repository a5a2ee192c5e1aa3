#include "file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tool/connection/failure.hpp"

namespace busbar::tool {

namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail_reading(const std::string& path, const std::string& why)
{
    throw Failure{Exit::Failed, path + ": cannot be read: " + why};
}

[[noreturn]] void fail_writing(const std::string& path)
{
    throw Failure{Exit::Failed, path + ": cannot be written: " + std::strerror(errno)};
}

} // namespace

std::string read_file(const std::string& path, std::size_t max_size)
{
    const File file{std::fopen(path.c_str(), "rbe")};
    if (!file) {
        fail_reading(path, std::strerror(errno));
    }
    std::string text;
    char block[4'096];
    while (const std::size_t size = std::fread(block, 1, sizeof block, file.get())) {
        text.append(block, size);
        if (text.size() > max_size) {
            fail_reading(path, "it is larger than " + std::to_string(max_size >> 20U) + " MiB");
        }
    }
    if (std::ferror(file.get()) != 0) {
        fail_reading(path, std::strerror(errno));
    }
    return text;
}

namespace {

void write_all(const std::string& path, File file, std::string_view text)
{
    if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() ||
        std::fflush(file.get()) != 0) {
        fail_writing(path);
    }
    if (std::fclose(file.release()) != 0) {
        fail_writing(path);
    }
}

} // namespace

void write_file(const std::string& path, std::string_view text)
{
    write_all(path, File{std::fopen(path.c_str(), "wbe")}, text);
}

bool is_stream(const std::string& path)
{
    struct stat place {};
    return ::stat(path.c_str(), &place) == 0 && (S_ISFIFO(place.st_mode) || S_ISCHR(place.st_mode));
}

void write_secret_file(const std::string& path, std::string_view text)
{
    if (is_stream(path)) { // its mode is not ours to change
        return write_file(path, text);
    }
    // Nothing is in it before its mode is right. A pipe without a reader is not waited for.
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC,
                            S_IRUSR | S_IWUSR);
    if (file < 0) {
        fail_writing(path);
    }
    struct stat found {};
    if (::fstat(file, &found) != 0 || !S_ISREG(found.st_mode) || found.st_uid != ::geteuid()) {
        ::close(file);
        throw Failure{Exit::Failed,
                      path + ": cannot be written: it is not a regular file of yours"};
    }
    if (::fchmod(file, S_IRUSR | S_IWUSR) != 0 || ::ftruncate(file, 0) != 0) {
        const int error = errno;
        ::close(file);
        errno = error;
        fail_writing(path);
    }
    write_all(path, File{::fdopen(file, "wb")}, text);
}

} // namespace busbar::tool
