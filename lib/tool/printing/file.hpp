#pragma once

#include <string>
#include <string_view>

namespace busbar::tool {

/// Certificates, keys and passwords are far smaller.
inline constexpr std::size_t max_file_size = 1U << 20U;

/// All of the file; throws Failure, which says why not: it may be longer than `max_size` bytes.
[[nodiscard]] std::string read_file(const std::string& path, std::size_t max_size = max_file_size);
/// Makes or replaces the file; throws Failure, which says why not.
void write_file(const std::string& path, std::string_view text);

} // namespace busbar::tool
