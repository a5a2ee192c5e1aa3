#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <busbar/core/result.hpp>

namespace busbar::crypto {

/// Who may read a file that is written.
enum class FileAccess : std::uint8_t { Owner, Everyone };

/// Makes or replaces the file `path` with `bytes`. After a power cut at any moment there is the old
/// file or the new one, never a part; with FileAccess::Owner no other user could read it at any
/// time. Bad_ResourceUnavailable if that fails, with nothing left behind. Blocks until it is on the
/// disk.
[[nodiscard]] Result<void> save_file(const std::string& path, std::span<const std::byte> bytes,
                                     FileAccess access);

} // namespace busbar::crypto
