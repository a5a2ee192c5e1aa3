#pragma once

#include <cstddef>
#include <span>

#include <busbar/core/extension_object.hpp>
#include <busbar/server/image_structure.hpp>

namespace busbar::server::detail {

// Converts values of structures between an image and the wire.

/// Returns whether each String and XmlElement of the structure at `from` is UTF-8 (Part 6,
/// 5.2.2.4).
[[nodiscard]] bool has_valid_texts(const ImageStructure& structure, const std::byte* from);

/// Writes the body of the structure at `from` (Part 6, 5.2.6) and returns its size. `to` has at
/// least max_wire_size() bytes.
[[nodiscard]] std::size_t encode_structure(const ImageStructure& structure, const std::byte* from,
                                           std::span<std::byte> to);

/// Checks the object and lays it out at `to`, which has size() bytes of zeros; their content is
/// undefined if it fails. Bad_TypeMismatch for another encoding or other lengths and dimensions,
/// Bad_OutOfRange for a text that is too long or a number outside its range, Bad_DecodingError for
/// a body that ends too early or too late.
[[nodiscard]] StatusCode decode_structure(const ImageStructure& structure,
                                          const ExtensionObject& object, std::byte* to);

/// Sets all texts of `place`, a variable or member at `to`, to null.
void clear_texts(const ImagePlace& place, std::byte* to);

/// Returns an object that borrows this structure type and body.
[[nodiscard]] ExtensionObject borrow_object(const ImageStructure& structure,
                                            std::span<const std::byte> body);

} // namespace busbar::server::detail
