#pragma once

#include <optional>

#include <busbar/binary/dynamic_types.hpp>
#include <busbar/core/api.hpp>

namespace busbar::binary::detail {

/// Facts about DataTypes that follow from the root of their hierarchy.
struct DataTypeRoot {
    DynamicType::Kind kind{DynamicType::Kind::Simple};
    BuiltInType built_in{BuiltInType::Null};
    /// The bits (by BuiltInType) of the types that a value may have; all for BaseDataType.
    std::uint32_t variant_types{UINT32_MAX};
    /// Structured option sets (Part 3, 8.40): Value and ValidBits, whatever the bits' names are.
    bool is_option_set_structure{false};
};

/// Returns nothing for an id that is not one of the types of Part 6, 5.1.2 or of the structures'
/// bases.
[[nodiscard]] BUSBAR_API std::optional<DataTypeRoot> data_type_root(const NodeId& data_type);

/// Structure, Union and OptionSet themselves stand for any subtype (Part 6, 5.1.7).
[[nodiscard]] bool is_open_structure(const NodeId& data_type);

} // namespace busbar::binary::detail
