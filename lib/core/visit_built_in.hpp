#pragma once

#include <busbar/core/types.hpp>

namespace busbar::detail {

template <typename T>
struct TypeTag {
    using type = T;
};

/// Calls `visitor(TypeTag<T>{})` with the C++ type of `type`, which must not be Null.
template <typename Visitor>
auto visit_built_in(BuiltInType type, Visitor&& visitor)
{
    switch (type) {
    // clang-format off
    case BuiltInType::Null:
    case BuiltInType::Boolean: return visitor(TypeTag<bool>{});
    case BuiltInType::SByte: return visitor(TypeTag<std::int8_t>{});
    case BuiltInType::Byte: return visitor(TypeTag<std::uint8_t>{});
    case BuiltInType::Int16: return visitor(TypeTag<std::int16_t>{});
    case BuiltInType::UInt16: return visitor(TypeTag<std::uint16_t>{});
    case BuiltInType::Int32: return visitor(TypeTag<std::int32_t>{});
    case BuiltInType::UInt32: return visitor(TypeTag<std::uint32_t>{});
    case BuiltInType::Int64: return visitor(TypeTag<std::int64_t>{});
    case BuiltInType::UInt64: return visitor(TypeTag<std::uint64_t>{});
    case BuiltInType::Float: return visitor(TypeTag<float>{});
    case BuiltInType::Double: return visitor(TypeTag<double>{});
    case BuiltInType::String: return visitor(TypeTag<String>{});
    case BuiltInType::DateTime: return visitor(TypeTag<DateTime>{});
    case BuiltInType::Guid: return visitor(TypeTag<Guid>{});
    case BuiltInType::ByteString: return visitor(TypeTag<ByteString>{});
    case BuiltInType::XmlElement: return visitor(TypeTag<XmlElement>{});
    case BuiltInType::NodeId: return visitor(TypeTag<NodeId>{});
    case BuiltInType::ExpandedNodeId: return visitor(TypeTag<ExpandedNodeId>{});
    case BuiltInType::StatusCode: return visitor(TypeTag<StatusCode>{});
    case BuiltInType::QualifiedName: return visitor(TypeTag<QualifiedName>{});
    case BuiltInType::LocalizedText: return visitor(TypeTag<LocalizedText>{});
    case BuiltInType::ExtensionObject: return visitor(TypeTag<ExtensionObject>{});
    case BuiltInType::DataValue: return visitor(TypeTag<DataValue>{});
    case BuiltInType::Variant: return visitor(TypeTag<Variant>{});
    case BuiltInType::DiagnosticInfo: return visitor(TypeTag<DiagnosticInfo>{});
        // clang-format on
    }
    return visitor(TypeTag<bool>{});
}

/// Texts can be cut by one more dimension of a NumericRange (Part 4, 7.27).
template <typename T>
inline constexpr bool is_text = std::is_same_v<T, String> || std::is_same_v<T, ByteString>;

} // namespace busbar::detail
