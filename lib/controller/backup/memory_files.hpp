#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/backup.hpp>

#include "backup_file.hpp"

namespace busbar::controller::detail {

/// Makes the problem that a file of the storage has.
[[nodiscard]] Unexpected<Problem> storage_problem(const Storage& storage, std::string_view name,
                                                  StorageError error);
[[nodiscard]] std::string_view memory_folder_of(std::string_view name);
/// Tells whether a file of this name belongs to the item.
[[nodiscard]] bool has_file(const MemoryItem& item, std::string_view name);

/// Names of the item's files that exist.
[[nodiscard]] Configured<std::vector<std::string>>
files_there(Storage& storage, const MemoryItem& item, const MemoryLimits& limits);
/// Reads the file that a part belongs to; a missing file counts as empty.
[[nodiscard]] Configured<std::vector<std::byte>> read_whole(Storage& storage, const FilePart& part,
                                                            const MemoryLimits& limits);
/// Takes the item's part out of a file's bytes: one file for a backup, or none.
[[nodiscard]] Configured<std::vector<SavedFile>> part_of(const MemoryItem& item,
                                                         std::span<const std::byte> whole);
/// Reads all of the item.
[[nodiscard]] Configured<SavedItem> read_item(Storage& storage, const MemoryItem& item,
                                              const MemoryLimits& limits);

} // namespace busbar::controller::detail
