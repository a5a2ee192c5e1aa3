#include <busbar/core/built_in_type.hpp>

#include <array>

namespace busbar {

namespace {

constexpr std::array<std::string_view, last_built_in_type + 1> names = {
    "Null",           "Boolean",       "SByte",           "Byte",           "Int16",
    "UInt16",         "Int32",         "UInt32",          "Int64",          "UInt64",
    "Float",          "Double",        "String",          "DateTime",       "Guid",
    "ByteString",     "XmlElement",    "NodeId",          "ExpandedNodeId", "StatusCode",
    "QualifiedName",  "LocalizedText", "ExtensionObject", "DataValue",      "Variant",
    "DiagnosticInfo",
};

} // namespace

std::string_view name(BuiltInType type)
{
    const auto index = static_cast<std::size_t>(type);
    return index < names.size() ? names[index] : std::string_view{};
}

} // namespace busbar
