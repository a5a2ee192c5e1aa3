#pragma once

#include <string>
#include <vector>

#include "value.hpp"

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

/// A value taken to pieces for printing: what is said of it on one line, and below that the fields
/// of a structure, the rows of a matrix or the elements of an array. All texts are `safe`.
struct ValuePart {
    std::string name;
    std::string text;
    /// Fields, rows, or elements that are structures.
    std::vector<ValuePart> parts;
    /// Elements that are not structures.
    std::vector<std::string> cells;
    /// Numbers, which stand below each other by their last digits.
    bool has_numbers{false};
    /// Number of elements of an array that were left out.
    std::size_t left_out{0};

    [[nodiscard]] bool is_simple() const { return parts.empty() && cells.empty(); }
};

/// At most `limit` elements of each array are taken, and as many bytes of a ByteString; 0: all.
/// `type`, which may be null, is the value's DataType.
[[nodiscard]] ValuePart parts_of(const Variant& value, const Types& types, std::size_t limit,
                                 const binary::DynamicType* type);

} // namespace busbar::tool
