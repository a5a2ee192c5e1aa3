#include "store_folders.hpp"

#include <array>
#include <filesystem>

#include <fcntl.h>
#include <sys/stat.h>

#include <busbar/core/text.hpp>
#include <busbar/crypto/file.hpp>

#include "descriptor.hpp"

namespace busbar::crypto::detail {

namespace {

namespace fs = std::filesystem;

/// Part 12, F.1.
constexpr std::array folders = {"own/certs",     "own/crl",     "trusted/certs",  "trusted/crl",
                                "issuers/certs", "issuers/crl", "rejected/certs", "rejected/crl"};
constexpr const char* private_folder = "own/private";
constexpr mode_t others = S_IRWXG | S_IRWXO;

/// A file or folder that only its owner may use from now on.
void close_to_others(const std::string& path, mode_t allowed, LogSink& log)
{
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat facts = {};
    if (!file.is_open() || ::fstat(file.get(), &facts) != 0 || (facts.st_mode & others) == 0) {
        return;
    }
    const bool is_closed = ::fchmod(file.get(), allowed) == 0;
    log.write(LogLevel::Warning, "certificate store",
              printable(path) + " was open to other users than its owner; " +
                  (is_closed ? "it is closed now" : "it cannot be closed") +
                  ". If somebody may have read a private key there, make a new one");
}

void close_private_keys(const std::string& folder, LogSink& log)
{
    close_to_others(folder, S_IRWXU, log);
    std::error_code error;
    for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
         at.increment(error)) {
        std::error_code unreadable;
        if (at->symlink_status(unreadable).type() == fs::file_type::regular) {
            close_to_others(at->path().string(), S_IRUSR | S_IWUSR, log);
        }
    }
}

} // namespace

Result<void> make_store_folders(const std::string& store, LogSink& log)
{
    std::error_code error;
    for (const char* name : folders) {
        const std::string folder = store + "/" + name;
        fs::create_directories(folder, error);
        if (error) {
            return fail(status::Bad_ConfigurationError);
        }
        remove_unfinished_files(folder);
    }
    const std::string keys = store + "/" + private_folder;
    // In no moment open to others.
    if (::mkdir(keys.c_str(), S_IRWXU) != 0 && !fs::is_directory(keys, error)) {
        return fail(status::Bad_ConfigurationError);
    }
    remove_unfinished_files(keys);
    close_private_keys(keys, log);
    return {};
}

} // namespace busbar::crypto::detail
