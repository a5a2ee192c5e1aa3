#pragma once

#include <string>
#include <string_view>

namespace busbar::client::detail {

/// Appends `text` in quotes as a JSON string that is safe to print on a terminal.
void append_json_string(std::string& to, std::string_view text);

} // namespace busbar::client::detail
