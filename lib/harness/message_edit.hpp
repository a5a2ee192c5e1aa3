#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::harness::detail {

/// Gives a field of a message's body another value: the path as MessageField has it, the text as
/// client::parse_value() reads it. Returns why that cannot be, with what was found and what was
/// expected; empty if it was done.
[[nodiscard]] std::string edit_message(std::vector<std::byte>& body, std::string_view path,
                                       std::string_view text);

} // namespace busbar::harness::detail
