#include "names.hpp"

#include <algorithm>
#include <iterator>

#include <busbar/types/ids.hpp>

namespace busbar::tool {

namespace {

/// Indexed by AttributeId, beginning with 1.
constexpr std::string_view attributes[] = {
#include <busbar/core/attribute_names.inc>
};
static_assert(std::size(attributes) == static_cast<std::size_t>(AttributeId::AccessLevelEx));

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
    return index < std::size(attributes) ? attributes[index] : "?";
}

std::vector<std::string> attribute_names()
{
    return {std::begin(attributes), std::end(attributes)};
}

std::optional<AttributeId> find_attribute(std::string_view name)
{
    const auto* const found = std::ranges::find(attributes, name);
    if (found == std::end(attributes)) {
        return std::nullopt;
    }
    return static_cast<AttributeId>(found - std::begin(attributes) + 1);
}

NodeId type_of(AttributeId attribute)
{
    switch (attribute) {
    case AttributeId::NodeClass:
        return {0, id::NodeClass};
    case AttributeId::WriteMask:
    case AttributeId::UserWriteMask:
        return {0, id::AttributeWriteMask};
    case AttributeId::EventNotifier:
        return {0, id::EventNotifierType};
    case AttributeId::AccessLevel:
    case AttributeId::UserAccessLevel:
        return {0, id::AccessLevelType};
    case AttributeId::AccessLevelEx:
        return {0, id::AccessLevelExType};
    case AttributeId::AccessRestrictions:
        return {0, id::AccessRestrictionType};
    default:
        return {};
    }
}

} // namespace busbar::tool
