#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <unistd.h>

#include <catch2/catch.hpp>

namespace busbar::test {

namespace fs = std::filesystem;

/// A folder that goes with its owner.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        // In memory if there is such a place: thousands of files are written and nothing is to
        // last.
        const fs::path memory{"/dev/shm"};
        const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
        std::string name =
            ((has_memory ? memory : fs::temp_directory_path()) / "busbar-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path = name;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder()
    {
        std::error_code error;
        fs::remove_all(path, error);
    }

    fs::path path;
};

} // namespace busbar::test
