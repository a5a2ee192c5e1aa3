#pragma once

#include <string>
#include <string_view>

namespace busbar::tool {

/// True if the text probably means a server rather than a node: opc.tcp://host:4840/path, another
/// scheme, or host:4840.
[[nodiscard]] bool is_url(std::string_view text);

/// Returns the URL in the form that the library takes, with the scheme if that was left out. Throws
/// a Failure, which says what is wrong, for a text that is not a URL.
[[nodiscard]] std::string complete_url(const std::string& text);

/// The host of a complete URL.
[[nodiscard]] std::string host_of(const std::string& url);

} // namespace busbar::tool
