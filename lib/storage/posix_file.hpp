#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/storage.hpp>

/// The single steps of a FolderStorage. Paths are those of the operating system.
namespace busbar::storage::detail {

/// What errno says.
[[nodiscard]] StorageError last_error();

/// Whether a file of this name, without its folder, is a temporary one.
[[nodiscard]] bool is_unfinished(std::string_view name);

/// Removes a temporary file unless somebody is about to write it.
void remove_dead(const std::string& path);

/// A new name is on the disk only when its folder is.
void sync_folder_of(const std::string& path);

/// See Storage::replace.
[[nodiscard]] Stored<void> save(const std::string& path, std::span<const std::byte> bytes,
                                FileAccess access);
/// What the bytes that were written outlast.
enum class Durability : std::uint8_t { ProgramEnd, PowerCut };

/// See Storage::append and append_unsynced.
[[nodiscard]] Stored<void> append(const std::string& path, std::span<const std::byte> bytes,
                                  FileAccess access, Durability durability);
/// See Storage::sync.
[[nodiscard]] Stored<void> sync(const std::string& path);
/// Also to another disk. A file that is at `to` is replaced.
[[nodiscard]] Stored<void> rename_durably(const std::string& from, const std::string& to);
/// As many bytes as there are, of a file that is open.
[[nodiscard]] Stored<std::size_t> read_from(int file, std::uint64_t offset,
                                            std::span<std::byte> into);

} // namespace busbar::storage::detail
