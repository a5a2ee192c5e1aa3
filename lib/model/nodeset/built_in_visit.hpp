#pragma once

#include <cstdint>
#include <type_traits>

#include <busbar/core/types.hpp>

namespace busbar::nodeset {

/// Calls `function` with the std::type_identity of the built-in type and returns its result; with
/// that of Variant for Null and DiagnosticInfo, whose values no file has.
template <typename Function>
decltype(auto) visit_built_in(BuiltInType type, Function function)
{
    // clang-format off
    switch (type) {
    case BuiltInType::Boolean: return function(std::type_identity<bool>{});
    case BuiltInType::SByte: return function(std::type_identity<std::int8_t>{});
    case BuiltInType::Byte: return function(std::type_identity<std::uint8_t>{});
    case BuiltInType::Int16: return function(std::type_identity<std::int16_t>{});
    case BuiltInType::UInt16: return function(std::type_identity<std::uint16_t>{});
    case BuiltInType::Int32: return function(std::type_identity<std::int32_t>{});
    case BuiltInType::UInt32: return function(std::type_identity<std::uint32_t>{});
    case BuiltInType::Int64: return function(std::type_identity<std::int64_t>{});
    case BuiltInType::UInt64: return function(std::type_identity<std::uint64_t>{});
    case BuiltInType::Float: return function(std::type_identity<float>{});
    case BuiltInType::Double: return function(std::type_identity<double>{});
    case BuiltInType::String: return function(std::type_identity<String>{});
    case BuiltInType::DateTime: return function(std::type_identity<DateTime>{});
    case BuiltInType::Guid: return function(std::type_identity<Guid>{});
    case BuiltInType::ByteString: return function(std::type_identity<ByteString>{});
    case BuiltInType::XmlElement: return function(std::type_identity<XmlElement>{});
    case BuiltInType::NodeId: return function(std::type_identity<NodeId>{});
    case BuiltInType::ExpandedNodeId: return function(std::type_identity<ExpandedNodeId>{});
    case BuiltInType::StatusCode: return function(std::type_identity<StatusCode>{});
    case BuiltInType::QualifiedName: return function(std::type_identity<QualifiedName>{});
    case BuiltInType::LocalizedText: return function(std::type_identity<busbar::LocalizedText>{});
    case BuiltInType::ExtensionObject: return function(std::type_identity<ExtensionObject>{});
    case BuiltInType::DataValue: return function(std::type_identity<DataValue>{});
    default: return function(std::type_identity<Variant>{});
    }
    // clang-format on
}

} // namespace busbar::nodeset
