#pragma once

#include <string>
#include <vector>

#include "value.hpp"

namespace busbar::tool {

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
