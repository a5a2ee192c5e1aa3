#pragma once

#include <string>
#include <vector>

namespace busbar::tool::watch {

/// Names of rows as a table has room for them, and the folder that is left out of each.
struct ShortNames {
    std::vector<std::string> names;
    std::string folder;
};

/// Leaves the numbers of namespaces out of paths, "2:Press/2:Speed", if no two of them become the
/// same, and then the folders that are the same in all. A name that is no path stays as it is.
[[nodiscard]] ShortNames short_names(const std::vector<std::string>& names);

} // namespace busbar::tool::watch
