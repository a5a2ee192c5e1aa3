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
/// file or the new one, never a part; with FileAccess::Owner no other user could read it at any
/// time. Bad_ResourceUnavailable if that fails, with nothing left behind. Blocks until it is on the
/// disk. Others may save the same file at the same time: one of them wins.
///
/// It is written under a temporary name beside `path`, which stays behind if the writer dies.
[[nodiscard]] BUSBAR_API Result<void>
save_file(const std::string& path, std::span<const std::byte> bytes, FileAccess access);

/// Gives the file another name, in another folder or on another disk too. In no moment, whether the
/// power is cut or not, it is under neither name. Never replaces a file: Bad_EntryExists;
/// Bad_ResourceUnavailable if anything else is wrong. Blocks as save_file.
[[nodiscard]] BUSBAR_API Result<void> move_file(const std::string& from, const std::string& to);

/// Blocks until it is gone from the disk. Bad_ResourceUnavailable.
[[nodiscard]] BUSBAR_API Result<void> remove_file(const std::string& path);

/// Whether a file of this name, without its folder, is a temporary one of save_file. Such a file
/// is never to be read.
[[nodiscard]] BUSBAR_API bool is_unfinished_file(std::string_view name);

/// Removes what writers that died left in `folder`. A writer that is at work gets an error.
BUSBAR_API void remove_unfinished_files(const std::string& folder);

} // namespace busbar::crypto
