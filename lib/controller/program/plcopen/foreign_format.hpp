#pragma once

#include <string>
#include <string_view>

namespace busbar::controller::detail {

/// Returns the name of the root of an XML document without its prefix, "<" if it has none;
/// empty if the text is not XML.
[[nodiscard]] std::string_view xml_root(std::string_view text);

/// Describes a file of a known format that is not read, by its first bytes or its root: "a ZIP
/// archive, such as a project of CODESYS". Empty for any other.
[[nodiscard]] std::string foreign_format(std::string_view bytes);

} // namespace busbar::controller::detail
