#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/backup.hpp>

#include "backup_file.hpp"

namespace busbar::controller::detail {

/// A problem with a file of the storage.
[[nodiscard]] Unexpected<Problem> storage_problem(const Storage& storage, std::string_view name,
                                                  StorageError error);
[[nodiscard]] std::string_view memory_folder_of(std::string_view name);
/// Whether a file of this name is one of the item.
[[nodiscard]] bool has_file(const MemoryItem& item, std::string_view name);

/// Names of the item's files that are there.
[[nodiscard]] Configured<std::vector<std::string>>
files_there(Storage& storage, const MemoryItem& item, const MemoryLimits& limits);
/// A part's file that is not there has no bytes.
[[nodiscard]] Configured<std::vector<std::byte>> read_whole(Storage& storage, const FilePart& part,
                                                            const MemoryLimits& limits);
/// The item's part of a file's bytes, as the one file in a backup or none.
[[nodiscard]] Configured<std::vector<SavedFile>> part_of(const MemoryItem& item,
                                                         std::span<const std::byte> whole);
/// All of the item.
[[nodiscard]] Configured<SavedItem> read_item(Storage& storage, const MemoryItem& item,
                                              const MemoryLimits& limits);

} // namespace busbar::controller::detail
