#pragma once

#include <string>
#include <string_view>

namespace busbar::tool {

/// True if the text probably means a server rather than a node: opc.tcp://host:4840/path, another
/// scheme, or host:4840.
[[nodiscard]] bool is_url(std::string_view text);

/// The URL as the library takes it, with the scheme if that was left out. Throws Failure for what
/// is none, which says what is wrong with it.
[[nodiscard]] std::string complete_url(const std::string& text);

/// The host of a complete URL.
[[nodiscard]] std::string host_of(const std::string& url);

} // namespace busbar::tool
