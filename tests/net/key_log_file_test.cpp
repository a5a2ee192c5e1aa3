#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <busbar/net/key_log_file.hpp>

#include "support/identity.hpp"

namespace key_log_file_test {

using namespace busbar;
using namespace busbar::test;
using net::KeyLogFile;

namespace {

struct Folder {
    Folder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "busbar-key-log-XXXXXX");
        path = ::mkdtemp(name.data());
    }
    ~Folder() { std::filesystem::remove_all(path); }

    std::filesystem::path path;
};

/// No file can grow beyond `size` as long as it is there.
class NoRoom {
public:
    explicit NoRoom(rlim_t size) : signal_{std::signal(SIGXFSZ, SIG_IGN)}
    {
        REQUIRE(::getrlimit(RLIMIT_FSIZE, &before_) == 0);
        rlimit small = before_;
        small.rlim_cur = size;
        REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    }
    NoRoom(const NoRoom&) = delete;
    NoRoom& operator=(const NoRoom&) = delete;
    ~NoRoom()
    {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }

private:
    rlimit before_{};
    void (*signal_)(int);
};

std::string contents(const std::string& path)
{
    std::ostringstream text;
    text << std::ifstream{path}.rdbuf();
    return text.str();
}

} // namespace

TEST_CASE("a key log is its owner's alone, loud, and grows", "[net][keylog]")
{
    const Folder folder;
    const std::string path = folder.path / "keys";
    LogBook log;
    const ::mode_t before = ::umask(0);
    for (const char* lines : {"one\n", "two\n"}) {
        const auto file = KeyLogFile::open(path, log);
        REQUIRE(file);
        (*file)->write(lines);
    }
    ::umask(before);
    CHECK(contents(path) == "one\ntwo\n");
    struct stat facts = {};
    REQUIRE(::stat(path.c_str(), &facts) == 0);
    CHECK((facts.st_mode & 0777U) == 0600U);
    CHECK(log.text.find("INSECURE: the keys of all channels are written to " + path) !=
          std::string::npos);
    CHECK(log.text.find("one") == std::string::npos);
}

TEST_CASE("keys go nowhere where others could read them", "[net][keylog]")
{
    const Folder folder;
    const std::string path = folder.path / "keys";
    LogBook log;
    const auto refused = [&] {
        const auto file = KeyLogFile::open(path, log);
        return !file && file.error() == status::Bad_ConfigurationError;
    };
    SECTION("a file that others may read")
    {
        std::ofstream{path} << "mine\n";
        ::chmod(path.c_str(), 0640);
        CHECK(refused());
        CHECK(contents(path) == "mine\n");
    }
    SECTION("a link")
    {
        std::filesystem::create_symlink(folder.path / "elsewhere", path);
        CHECK(refused());
        CHECK_FALSE(std::filesystem::exists(folder.path / "elsewhere"));
    }
    SECTION("a pipe that nobody reads")
    {
        REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
        CHECK(refused());
    }
    SECTION("a pipe that somebody reads")
    {
        REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
        const int reader = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        REQUIRE(reader >= 0);
        CHECK(refused());
        ::close(reader);
        CHECK(log.text.find("it is not a regular file") != std::string::npos);
    }
    SECTION("a file of somebody else")
    {
        std::ofstream{path} << "theirs\n";
        ::chmod(path.c_str(), 0600);
        if (::chown(path.c_str(), 65'534, 65'534) != 0) {
            REQUIRE(::geteuid() != 0);
            return; // only the superuser can make one
        }
        CHECK(refused());
        CHECK(log.text.find("it belongs to another user") != std::string::npos);
        CHECK(contents(path) == "theirs\n");
    }
    SECTION("a folder")
    {
        std::filesystem::create_directory(path);
        CHECK(refused());
    }
    CHECK(log.text.find("is not used") != std::string::npos);
}

TEST_CASE("keys that there is no room for are lost, and the log says so", "[net][keylog]")
{
    const Folder folder;
    const std::string path = folder.path / "keys";
    LogBook log;
    const auto file = KeyLogFile::open(path, log);
    REQUIRE(file);
    (*file)->write("0123");
    {
        const NoRoom none{8};
        (*file)->write("456789"); // there is room for some of it
    }
    CHECK(contents(path) == "01234567");
    CHECK(log.text.find("key log: the keys of a channel could not be written") !=
          std::string::npos);
    (*file)->write("\nnext\n");
    CHECK(contents(path) == "01234567\nnext\n");
}

} // namespace key_log_file_test
