#pragma once

namespace busbar::model::detail {

/// True for the NodeClasses of types (Part 3, 5.9), for the enumerations of services and of files:
/// both give each NodeClass the same bit (Part 3, 8.29).
template <typename NodeClass>
[[nodiscard]] constexpr bool is_type(NodeClass node_class)
{
    constexpr unsigned types = static_cast<unsigned>(NodeClass::ObjectType) |
                               static_cast<unsigned>(NodeClass::VariableType) |
                               static_cast<unsigned>(NodeClass::ReferenceType) |
                               static_cast<unsigned>(NodeClass::DataType);
    return (static_cast<unsigned>(node_class) & types) != 0;
}

} // namespace busbar::model::detail
