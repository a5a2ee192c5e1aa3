#include "names.hpp"

#include <algorithm>
#include <array>

namespace busbar::cli {

namespace {

/// By AttributeId, from 1 on (Part 6, A.1).
constexpr std::array<std::string_view, 27> attributes{
    "NodeId",
    "NodeClass",
    "BrowseName",
    "DisplayName",
    "Description",
    "WriteMask",
    "UserWriteMask",
    "IsAbstract",
    "Symmetric",
    "InverseName",
    "ContainsNoLoops",
    "EventNotifier",
    "Value",
    "DataType",
    "ValueRank",
    "ArrayDimensions",
    "AccessLevel",
    "UserAccessLevel",
    "MinimumSamplingInterval",
    "Historizing",
    "Executable",
    "UserExecutable",
    "DataTypeDefinition",
    "RolePermissions",
    "UserRolePermissions",
    "AccessRestrictions",
    "AccessLevelEx",
};

} // namespace

std::string_view name(NodeClass node_class)
{
    switch (node_class) {
    case NodeClass::Object:
        return "Object";
    case NodeClass::Variable:
        return "Variable";
    case NodeClass::Method:
        return "Method";
    case NodeClass::ObjectType:
        return "ObjectType";
    case NodeClass::VariableType:
        return "VariableType";
    case NodeClass::ReferenceType:
        return "ReferenceType";
    case NodeClass::DataType:
        return "DataType";
    case NodeClass::View:
        return "View";
    default:
        return "?";
    }
}

std::string_view name(AttributeId attribute)
{
    const std::size_t index = static_cast<std::size_t>(attribute) - 1;
    return index < attributes.size() ? attributes[index] : "?";
}

std::optional<AttributeId> find_attribute(std::string_view name)
{
    const auto found = std::find(attributes.begin(), attributes.end(), name);
    if (found == attributes.end()) {
        return std::nullopt;
    }
    return static_cast<AttributeId>(found - attributes.begin() + 1);
}

} // namespace busbar::cli
