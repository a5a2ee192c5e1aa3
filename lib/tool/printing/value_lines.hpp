#pragma once

#include <string>
#include <vector>

#include "value_parts.hpp"

namespace CLI {
class App;
}

namespace busbar::tool {

/// Limits of the printed part of a value, and its width.
struct ValueLimits {
    /// Elements of each array, and lines of a value; 0: all. What is left out is said.
    std::size_t count{100};
};
void add_limit_option(CLI::App& command, ValueLimits& limits);

/// A value for people: one line of text, and those below it.
struct ValueText {
    std::string text;
    std::vector<std::string> lines;
};

/// The fields of structures on lines of their own, with those of the structures in them below;
/// elements of arrays in columns. Lines are at most `columns` wide, cut if they have to be and are
/// limited at all; SIZE_MAX: arrays take 80 columns, and nothing is cut.
[[nodiscard]] ValueText lines_of(const Variant& value, const Types& types,
                                 const ValueLimits& limits, std::size_t columns,
                                 const NodeId& data_type = {});
/// The value, or the name of a bad status.
[[nodiscard]] ValueText lines_of(const DataValue& value, const Types& types,
                                 const ValueLimits& limits, std::size_t columns,
                                 const NodeId& data_type = {});

} // namespace busbar::tool
