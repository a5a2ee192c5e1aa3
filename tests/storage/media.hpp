#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include <busbar/storage/folder_storage.hpp>
#include <busbar/storage/memory_storage.hpp>

#include "support/temporary_folder.hpp"

namespace busbar::test {

inline std::span<const std::byte> bytes_of(std::string_view text)
{
    return std::as_bytes(std::span<const char>{text.data(), text.size()});
}

/// The file's text; "!" and the error if it cannot be read.
inline std::string read(Storage& storage, std::string_view name, std::size_t max_size = 1'000)
{
    const auto bytes = read_file(storage, name, max_size);
    if (!bytes) {
        return "!" + std::string{text(bytes.error())};
    }
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

inline Stored<void> put(Storage& storage, std::string_view name, std::string_view text)
{
    return storage.replace(name, bytes_of(text), FileAccess::Everyone);
}

inline Stored<void> add(Storage& storage, std::string_view name, std::string_view text)
{
    return storage.append(name, bytes_of(text), FileAccess::Everyone);
}

inline std::vector<std::string> names(Storage& storage, std::string_view folder)
{
    std::vector<std::string> result;
    const auto listing = storage.list(folder, 100);
    REQUIRE(listing);
    for (const StorageEntry& entry : listing->entries) {
        result.push_back(entry.name + (entry.kind == StorageEntry::Kind::Folder ? "/" : ""));
    }
    return result;
}

/// What holds the files of a test: a folder of the system, or memory.
struct Medium {
    std::string name;
    TemporaryFolder folder;
    std::unique_ptr<Storage> storage;
};

inline std::unique_ptr<Medium> on_disk()
{
    auto medium = std::make_unique<Medium>();
    medium->name = "folder";
    medium->storage = std::make_unique<storage::FolderStorage>(medium->folder.path.string());
    return medium;
}

inline std::unique_ptr<Medium> in_memory()
{
    auto medium = std::make_unique<Medium>();
    medium->name = "memory";
    medium->storage = std::make_unique<storage::MemoryStorage>();
    return medium;
}

} // namespace busbar::test
