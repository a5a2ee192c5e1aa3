#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>

namespace busbar::detail {

/// Removes what interrupted calls of Storage::replace left in a folder and in those below it. Call
/// it once at a start for each root that a program writes below: these files are not listed, and
/// take space. Folders that cannot be listed, and those too deep, are skipped.
inline void remove_unfinished_below(Storage& storage, std::string_view folder,
                                    std::size_t max_depth = 8)
{
    constexpr std::size_t max_entries = 10'000;
    storage.remove_unfinished(folder);
    const auto listing = storage.list(folder, max_entries);
    if (!listing || max_depth == 0) {
        return;
    }
    for (const StorageEntry& each : listing->entries) {
        if (each.kind == StorageEntry::Kind::Folder) {
            remove_unfinished_below(storage, storage_path(folder, each.name), max_depth - 1);
        }
    }
}

} // namespace busbar::detail
