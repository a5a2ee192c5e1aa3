#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include <busbar/core/api.hpp>
#include <busbar/core/date_time.hpp>
#include <busbar/core/guid.hpp>
#include <busbar/core/node_id.hpp>
#include <busbar/core/status_code.hpp>
#include <busbar/core/string.hpp>
#include <busbar/core/text.hpp>

namespace busbar {

/// The built-in types by their ids (Part 6, 5.1.2). Null is the type of an empty Variant.
enum class BuiltInType : std::uint8_t {
    Null = 0,
    Boolean = 1,
    SByte = 2,
    Byte = 3,
    Int16 = 4,
    UInt16 = 5,
    Int32 = 6,
    UInt32 = 7,
    Int64 = 8,
    UInt64 = 9,
    Float = 10,
    Double = 11,
    String = 12,
    DateTime = 13,
    Guid = 14,
    ByteString = 15,
    XmlElement = 16,
    NodeId = 17,
    ExpandedNodeId = 18,
    StatusCode = 19,
    QualifiedName = 20,
    LocalizedText = 21,
    ExtensionObject = 22,
    DataValue = 23,
    Variant = 24,
    DiagnosticInfo = 25,
};

/// The largest number of a BuiltInType; larger ones are reserved (Part 6, 5.1.2).
inline constexpr std::uint8_t last_built_in_type = 25;

/// "Int32"; "Null" for BuiltInType::Null. The view is of constant data.
[[nodiscard]] BUSBAR_API std::string_view name(BuiltInType type);

class ExtensionObject;
struct DataValue;
class Variant;
struct DiagnosticInfo;

namespace detail {

template <BuiltInType Id>
using BuiltInId = std::integral_constant<BuiltInType, Id>;

template <typename T>
struct BuiltInTypeOf {
};

// clang-format off
template <> struct BuiltInTypeOf<bool> : BuiltInId<BuiltInType::Boolean> {};
template <> struct BuiltInTypeOf<std::int8_t> : BuiltInId<BuiltInType::SByte> {};
template <> struct BuiltInTypeOf<std::uint8_t> : BuiltInId<BuiltInType::Byte> {};
template <> struct BuiltInTypeOf<std::int16_t> : BuiltInId<BuiltInType::Int16> {};
template <> struct BuiltInTypeOf<std::uint16_t> : BuiltInId<BuiltInType::UInt16> {};
template <> struct BuiltInTypeOf<std::int32_t> : BuiltInId<BuiltInType::Int32> {};
template <> struct BuiltInTypeOf<std::uint32_t> : BuiltInId<BuiltInType::UInt32> {};
template <> struct BuiltInTypeOf<std::int64_t> : BuiltInId<BuiltInType::Int64> {};
template <> struct BuiltInTypeOf<std::uint64_t> : BuiltInId<BuiltInType::UInt64> {};
template <> struct BuiltInTypeOf<float> : BuiltInId<BuiltInType::Float> {};
template <> struct BuiltInTypeOf<double> : BuiltInId<BuiltInType::Double> {};
template <> struct BuiltInTypeOf<String> : BuiltInId<BuiltInType::String> {};
template <> struct BuiltInTypeOf<DateTime> : BuiltInId<BuiltInType::DateTime> {};
template <> struct BuiltInTypeOf<Guid> : BuiltInId<BuiltInType::Guid> {};
template <> struct BuiltInTypeOf<ByteString> : BuiltInId<BuiltInType::ByteString> {};
template <> struct BuiltInTypeOf<XmlElement> : BuiltInId<BuiltInType::XmlElement> {};
template <> struct BuiltInTypeOf<NodeId> : BuiltInId<BuiltInType::NodeId> {};
template <> struct BuiltInTypeOf<ExpandedNodeId> : BuiltInId<BuiltInType::ExpandedNodeId> {};
template <> struct BuiltInTypeOf<StatusCode> : BuiltInId<BuiltInType::StatusCode> {};
template <> struct BuiltInTypeOf<QualifiedName> : BuiltInId<BuiltInType::QualifiedName> {};
template <> struct BuiltInTypeOf<LocalizedText> : BuiltInId<BuiltInType::LocalizedText> {};
template <> struct BuiltInTypeOf<ExtensionObject> : BuiltInId<BuiltInType::ExtensionObject> {};
template <> struct BuiltInTypeOf<DataValue> : BuiltInId<BuiltInType::DataValue> {};
template <> struct BuiltInTypeOf<Variant> : BuiltInId<BuiltInType::Variant> {};
template <> struct BuiltInTypeOf<DiagnosticInfo> : BuiltInId<BuiltInType::DiagnosticInfo> {};
// clang-format on

} // namespace detail

/// True for the 25 C++ types that stand for the built-in types.
template <typename T>
concept BuiltIn = requires
{
    detail::BuiltInTypeOf<T>::value;
};

/// The id of a C++ type that is a built-in type.
template <BuiltIn T>
inline constexpr BuiltInType built_in_type_of = detail::BuiltInTypeOf<T>::value;

} // namespace busbar
