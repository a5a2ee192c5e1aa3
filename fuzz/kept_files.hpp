#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <busbar/core/storage.hpp>
#include <busbar/storage/memory_storage.hpp>

namespace busbar::fuzz {

/// Files and folders of a medium as they were at one moment, to be put back after an input. What
/// cannot be put back, such as a folder that has become a file, stays.
class KeptFiles {
public:
    /// `files` must outlive this.
    explicit KeptFiles(storage::MemoryStorage& files) : files_{files} {}

    void keep()
    {
        contents_.clear();
        folders_.clear();
        for (const std::string& name : files_.names()) {
            contents_[name] = contents(name);
        }
        for (const std::string& folder : folders_below({})) {
            folders_.insert(folder);
        }
        steps_ = files_.steps();
    }
    /// False if there was nothing to put back.
    bool restore()
    {
        if (files_.steps() == steps_) {
            return false;
        }
        for (const std::string& name : files_.names()) {
            if (!contents_.contains(name)) {
                static_cast<void>(files_.remove(name));
            }
        }
        std::vector<std::string> found = folders_below({});
        std::reverse(found.begin(), found.end()); // those within before those around
        for (const std::string& folder : found) {
            if (!folders_.contains(folder)) {
                static_cast<void>(files_.remove(folder));
            }
        }
        for (const std::string& folder : folders_) {
            if (!files_.entry(folder)) {
                static_cast<void>(files_.make_folder(folder, FileAccess::Owner));
            }
        }
        for (const auto& [name, bytes] : contents_) {
            if (contents(name) != bytes) {
                static_cast<void>(files_.replace(name, bytes, FileAccess::Owner));
            }
        }
        steps_ = files_.steps();
        return true;
    }

private:
    static constexpr std::size_t most_entries = 100;
    static constexpr std::size_t most_bytes = 1U << 20U;

    [[nodiscard]] std::vector<std::byte> contents(const std::string& name)
    {
        return read_file(files_, name, most_bytes).value_or(std::vector<std::byte>{});
    }
    /// Folders before those within.
    [[nodiscard]] std::vector<std::string> folders_below(const std::string& folder)
    {
        std::vector<std::string> all;
        const auto listing = files_.list(folder, most_entries);
        for (const StorageEntry& each : listing ? listing->entries : std::vector<StorageEntry>{}) {
            if (each.kind == StorageEntry::Kind::Folder) {
                all.push_back(storage_path(folder, each.name));
                const auto within = folders_below(all.back());
                all.insert(all.end(), within.begin(), within.end());
            }
        }
        return all;
    }

    storage::MemoryStorage& files_;
    std::map<std::string, std::vector<std::byte>> contents_;
    std::set<std::string> folders_;
    std::size_t steps_{0};
};

} // namespace busbar::fuzz
