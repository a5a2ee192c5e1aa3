#pragma once

#include <vector>

#include <busbar/binary/codec.hpp>

/// Converts structures that are C++ objects into dynamic values.
namespace busbar::binary::detail {

/// Returns the bytes of an object's body; errors as encode.
[[nodiscard]] Result<std::vector<std::byte>> encoded_body(const ExtensionObject& object);

/// Encodes the C++ objects in `value`, also those in Variants and DataValues within it. Objects
/// before an error stay encoded.
Result<void> encode_objects(Variant& value);

} // namespace busbar::binary::detail
