#pragma once

#include <string>
#include <vector>

#include "tool/connection/context.hpp"

namespace busbar::tool {

/// One thing that differs, with the text of each side; empty if a side does not have it.
struct Difference {
    std::string what;
    std::string first;
    std::string second;
};

/// Titles of the table, which are the names of the members in JSON in small letters.
struct DifferenceTitles {
    const char* what;
    const char* first;
    const char* second;
    /// Text in the table where a side does not have the row.
    const char* nothing{""};
};

/// Prints a table, or in JSON {"differences": [...], "isSame": false}; Failed if there is one.
Exit print_differences(Context& context, const std::vector<Difference>& differences,
                       const DifferenceTitles& titles);

} // namespace busbar::tool
