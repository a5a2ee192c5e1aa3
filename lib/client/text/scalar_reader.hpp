#pragma once

#include <optional>
#include <string>

#include <busbar/binary/dynamic_value.hpp>

#include "core/json.hpp"

namespace busbar::client::detail {

using busbar::detail::Json;

/// Reads a scalar from `from`; false if it is not of this type. A String of JSON is a text as well
/// as a number in quotes. There is an overload for each built-in type with a text form.
[[nodiscard]] bool read_scalar(const Json& from, bool& to);
[[nodiscard]] bool read_scalar(const Json& from, std::int8_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::uint8_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::int16_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::uint16_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::int32_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::uint32_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::int64_t& to);
[[nodiscard]] bool read_scalar(const Json& from, std::uint64_t& to);
[[nodiscard]] bool read_scalar(const Json& from, float& to);
[[nodiscard]] bool read_scalar(const Json& from, double& to);
[[nodiscard]] bool read_scalar(const Json& from, String& to);
[[nodiscard]] bool read_scalar(const Json& from, XmlElement& to);
[[nodiscard]] bool read_scalar(const Json& from, DateTime& to);
[[nodiscard]] bool read_scalar(const Json& from, Guid& to);
[[nodiscard]] bool read_scalar(const Json& from, ByteString& to);
[[nodiscard]] bool read_scalar(const Json& from, NodeId& to);
[[nodiscard]] bool read_scalar(const Json& from, ExpandedNodeId& to);
[[nodiscard]] bool read_scalar(const Json& from, StatusCode& to);
[[nodiscard]] bool read_scalar(const Json& from, QualifiedName& to);
[[nodiscard]] bool read_scalar(const Json& from, LocalizedText& to);

/// Returns the number of an enumeration's value, or of "A|B" for an option set; nothing for other
/// texts.
[[nodiscard]] std::optional<std::int64_t> number_of_name(std::string_view text,
                                                         const binary::DynamicType& type);

/// Describes the values of a type for messages: "a Byte, 0 to 255". `named`, which may be null, is
/// the DataType, which may be a time of IEC 61131-3.
[[nodiscard]] std::string expectation(BuiltInType type, const binary::DynamicType* named);
/// Describes those of an enumeration: "a number or name of Mode: Off, Manual, ...".
[[nodiscard]] std::string expectation(const binary::DynamicType& type);

} // namespace busbar::client::detail
