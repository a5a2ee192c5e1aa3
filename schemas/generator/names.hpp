#pragma once

#include <string>
#include <string_view>

/// C++ spelling of the specification's names.
namespace busbar::generator {

/// "RequestedMaxReferencesPerNode" to "requested_max_references_per_node", never a keyword.
[[nodiscard]] std::string field_name(std::string_view name);

/// Returns the name, changed if C++ does not allow it: ThreeDFrame for "3DFrame", default_.
[[nodiscard]] std::string type_name(std::string_view name);

/// `text` as a C++ string literal.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// The definition of a constant array of char, a string literal in pieces, with what is not
/// printable as three octal digits.
[[nodiscard]] std::string byte_table(const char* name, std::string_view bytes);

} // namespace busbar::generator
