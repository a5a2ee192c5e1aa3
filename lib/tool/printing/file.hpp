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
/// True for a pipe or a device, such as /dev/stdout: it keeps all that is ever written to it.
[[nodiscard]] bool is_stream(const std::string& path);
/// As write_file() with a file that only its owner can read, for what was secret; one that is there
/// already becomes such a file. Links and files of others are refused; a pipe or a device gets the
/// text as it is.
void write_secret_file(const std::string& path, std::string_view text);

} // namespace busbar::tool
