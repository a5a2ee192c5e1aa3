#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <sys/stat.h>

#include <catch2/catch.hpp>

#include <busbar/crypto/certificate_store.hpp>
#include <busbar/storage/folder_storage.hpp>

#include "issuing.hpp"
#include "support/temporary_folder.hpp"

namespace busbar::test {

namespace fs = std::filesystem;

class LogBook final : public LogSink {
public:
    void write(LogLevel, std::string_view source, std::string_view message) override
    {
        lines.push_back(std::string{source} + ": " + std::string{message});
    }
    [[nodiscard]] std::size_t count(std::string_view text) const
    {
        return static_cast<std::size_t>(
            std::count_if(lines.begin(), lines.end(), [&](const std::string& line) {
                return line.find(text) != std::string::npos;
            }));
    }

    std::vector<std::string> lines;
};

inline void write_file(const fs::path& file, std::span<const std::byte> bytes)
{
    std::ofstream stream{file, std::ios::binary};
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    REQUIRE(stream.good());
}

inline void write_text(const fs::path& file, std::string_view text)
{
    write_file(file, std::as_bytes(std::span{text}));
}

inline unsigned mode_of(const fs::path& file)
{
    struct stat facts = {};
    REQUIRE(::lstat(file.c_str(), &facts) == 0);
    return static_cast<unsigned>(facts.st_mode) & 07777U;
}

/// What a writer leaves whose power was cut.
inline bool is_unfinished(const fs::path& file)
{
    return file.extension() == ".busbar-new";
}

/// Late enough for every file that a test writes to count as settled.
[[nodiscard]] inline DateTime long_after()
{
    return {DateTime::latest};
}

/// A CertificateStore with verbs.
class StoreFixture {
public:
    explicit StoreFixture(const crypto::StoreLimits& limits = {}) : store{files, limits, log}
    {
        REQUIRE(store.create());
    }

    [[nodiscard]] fs::path path(const std::string& name) const { return folder.path / name; }
    /// As a tool does it: the file is simply there.
    void put(const std::string& name, std::span<const std::byte> bytes) const
    {
        write_file(path(name), bytes);
    }
    [[nodiscard]] std::size_t count(const std::string& name) const
    {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator{path(name)}, fs::directory_iterator{}));
    }
    /// The thumbprints of a list.
    [[nodiscard]] std::set<std::string> in(crypto::StoreList list)
    {
        std::set<std::string> result;
        for (const crypto::StoreEntry& entry : store.list(list)) {
            result.insert(entry.thumbprint);
        }
        return result;
    }

    TemporaryFolder folder;
    storage::FolderStorage files{folder.path.string()};
    LogBook log;
    crypto::CertificateStore store;
};

} // namespace busbar::test
