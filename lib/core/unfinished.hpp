#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>

namespace busbar::detail {

/// Removes what calls of Storage::replace left in a folder and in those below it when their power
/// was cut. To be called once, at a start, for each root that a program writes below: what is left
/// is not listed, and takes room. Folders that cannot be listed, and those too deep, keep theirs.
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
