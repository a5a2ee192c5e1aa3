#pragma once

#include <vector>

#include <busbar/binary/codec.hpp>

/// Structures that are C++ objects, on their way into dynamic values.
namespace busbar::binary::detail {

/// The bytes of an object's body; errors as encode.
[[nodiscard]] Result<std::vector<std::byte>> encoded_body(const ExtensionObject& object);

/// Encodes the C++ objects in `value`, also those in Variants and DataValues within it. What was
/// done before an error stays.
Result<void> encode_objects(Variant& value);

} // namespace busbar::binary::detail
