#pragma once

#include <string>
#include <vector>

#include "model.hpp"
#include "screen.hpp"
#include "tool/nodes/variable_facts.hpp"

namespace busbar::tool::watch {

/// Widths of the table's columns; 0 for one that has no room. The value always has some.
struct Columns {
    std::size_t name;
    std::size_t value;
    std::size_t trend;
    std::size_t age;
    /// Without it a status that is not Good stands with the value.
    std::size_t status;
};

/// The places of all parts; a part with 0 rows is left out.
struct Layout {
    Columns columns;
    bool has_title;
    bool has_link;
    bool has_header;
    bool has_bottom;
    std::size_t table_rows;
    /// Number of rows for events, including their title.
    std::size_t event_rows;
};

[[nodiscard]] Layout layout_of(const Model& model, Size size);

/// The picture of a model that was fit() to the layout's table_rows. `has_unicode`: whether the
/// terminal shows characters beyond ASCII.
[[nodiscard]] Screen render(const Model& model, Size size, const Now& now, bool has_unicode);

/// Returns all that is known of a row as lines of at most `columns`: the whole value, its type,
/// status and times. `node` is the NodeId that the server uses.
[[nodiscard]] std::vector<std::string> details_of(const Row& row, const std::string& node,
                                                  const ValueFacts& facts, const Types& types,
                                                  std::size_t columns);

} // namespace busbar::tool::watch
