#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <busbar/net/key_log_file.hpp>

#include "support/identity.hpp"

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
    SECTION("a folder")
    {
        std::filesystem::create_directory(path);
        CHECK(refused());
    }
    CHECK(log.text.find("is not used") != std::string::npos);
}
