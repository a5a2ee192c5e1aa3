#pragma once

#include <cstddef>
#include <span>

#include <busbar/core/extension_object.hpp>
#include <busbar/server/image_structure.hpp>

namespace busbar::server::detail {

// Values of structures between an image and the wire.

/// Writes the body of the structure that lies at `from` (Part 6, 5.2.6) and gives its size. `to`
/// has at least max_wire_size() bytes.
[[nodiscard]] std::size_t encode_structure(const ImageStructure& structure, const std::byte* from,
                                           std::span<std::byte> to);

/// Checks the object and lays it out at `to`, where there are size() bytes of zeros; these may be
/// anything if it fails. Bad_TypeMismatch for another encoding or other lengths and dimensions,
/// Bad_OutOfRange for a text that is too long or a number outside its range, Bad_DecodingError for
/// a body that ends too early or too late.
[[nodiscard]] StatusCode decode_structure(const ImageStructure& structure,
                                          const ExtensionObject& object, std::byte* to);

/// Makes all texts of `place`, a variable or member that lies at `to`, null.
void clear_texts(const ImagePlace& place, std::byte* to);

/// An object with this body, both of which it does not own.
[[nodiscard]] ExtensionObject borrow_object(const ImageStructure& structure,
                                            std::span<const std::byte> body);

} // namespace busbar::server::detail
