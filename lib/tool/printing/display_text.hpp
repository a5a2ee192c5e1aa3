#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace busbar::tool {

/// Makes the text of a server safe for a terminal: one line, no control characters, nothing that
/// changes the direction of writing. Such characters are replaced by \x1B or \u202E.
[[nodiscard]] std::string safe(std::string_view text);
/// Does the same with a text of several lines, which become one: "first; second".
[[nodiscard]] std::string safe_line(std::string_view lines);

/// Columns that `safe` text takes: two for wide East Asian characters, none for combining ones.
[[nodiscard]] std::size_t display_width(std::string_view text);

/// Takes the first character off `safe` text, which is not empty.
[[nodiscard]] std::string_view take_character(std::string_view& text);

/// `text` cut to at most `columns`, the last three "..." if something was left out.
[[nodiscard]] std::string cut(std::string_view text, std::size_t columns);

/// The same with "..." instead of the front: the end of a path says more than its beginning.
[[nodiscard]] std::string cut_front(std::string_view text, std::size_t columns);

/// `text` in lines of at most `columns`, broken at blanks; each after the first begins with
/// `indent` blanks.
[[nodiscard]] std::string wrap(std::string_view text, std::size_t columns, std::size_t indent);

} // namespace busbar::tool
