#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <busbar/core/api.hpp>
#include <busbar/core/result.hpp>

namespace busbar::crypto {

/// Who may read a file that is written.
enum class FileAccess : std::uint8_t { Owner, Everyone };

/// Makes or replaces the file `path` with `bytes`. After a power cut at any moment there is the old
/// file or the new one, never a part. With FileAccess::Owner no other user can read it at any time.
/// Bad_ResourceUnavailable if it fails, with nothing left behind. Blocks until it is on the disk.
/// If others save the same file at the same time, one of them wins.
///
/// It is written under a temporary name beside `path`, which stays behind if the writer dies.
[[nodiscard]] BUSBAR_API Result<void>
save_file(const std::string& path, std::span<const std::byte> bytes, FileAccess access);

/// Gives the file another name, also in another folder or on another disk. At no moment, not even
/// after a power cut, is it under neither name. Never replaces a file: Bad_EntryExists.
/// Bad_ResourceUnavailable for any other failure. Blocks as save_file does.
[[nodiscard]] BUSBAR_API Result<void> move_file(const std::string& from, const std::string& to);

/// Removes a file and blocks until it is gone from the disk. Bad_ResourceUnavailable.
[[nodiscard]] BUSBAR_API Result<void> remove_file(const std::string& path);

/// Whether a file of this name, without its folder, is a temporary one of save_file. Such a file
/// is never to be read.
[[nodiscard]] BUSBAR_API bool is_unfinished_file(std::string_view name);

/// Removes what writers that died left in `folder`. A writer that is at work then fails.
BUSBAR_API void remove_unfinished_files(const std::string& folder);

} // namespace busbar::crypto
