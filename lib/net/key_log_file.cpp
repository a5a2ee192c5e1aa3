#include <busbar/net/key_log_file.hpp>

#include <cerrno>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace busbar::net {

namespace {

constexpr std::string_view source = "key log";

/// Returns an empty text if the open file may hold keys, else the reason why not.
std::string_view objection_to(int file)
{
    struct stat facts = {};
    if (::fstat(file, &facts) != 0 || !S_ISREG(facts.st_mode)) {
        return "it is not a regular file";
    }
    if (facts.st_uid != ::geteuid()) {
        return "it belongs to another user";
    }
    return (facts.st_mode & (S_IRWXG | S_IRWXO)) == 0 ? "" : "others may read or write it";
}

} // namespace

Result<std::unique_ptr<KeyLogFile>> KeyLogFile::open(const std::string& path, LogSink& log)
{
    constexpr int flags = O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
    const int file = ::open(path.c_str(), flags, S_IRUSR | S_IWUSR);
    const std::string_view objection = file < 0 ? "it cannot be opened" : objection_to(file);
    if (!objection.empty()) {
        if (file >= 0) {
            ::close(file);
        }
        log.write(LogLevel::Error, source, path + " is not used: " + std::string{objection});
        return fail(status::Bad_ConfigurationError);
    }
    log.write(LogLevel::Error, source,
              "INSECURE: the keys of all channels are written to " + path +
                  ". With that file all traffic between clients and server can be decrypted. "
                  "For test benches only");
    return std::unique_ptr<KeyLogFile>{new KeyLogFile{file, log}};
}

KeyLogFile::~KeyLogFile()
{
    ::close(file_);
}

void KeyLogFile::write(std::string_view lines)
{
    const std::lock_guard lock{mutex_};
    while (!lines.empty()) {
        const ssize_t size = ::write(file_, lines.data(), lines.size());
        if (size < 0 && errno == EINTR) {
            continue;
        }
        if (size <= 0) {
            log_->write(LogLevel::Error, source, "the keys of a channel could not be written");
            return;
        }
        lines.remove_prefix(static_cast<std::size_t>(size));
    }
}

} // namespace busbar::net
