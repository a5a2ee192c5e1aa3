#pragma once

#include <cstddef>

#include <busbar/backend/label.hpp>

/// Copy a label's value between a program's memory, laid out as an image lays it out, and the bytes
/// of a request. Neither function allocates; `wire` has backend::size_of(kind) bytes.
namespace busbar::controller::detail {

/// Reads a label. TIMEs are rounded to milliseconds and limited to 32 bits; zeros follow a text.
void load_label(const backend::LabelKind& kind, const std::byte* memory, std::byte* wire);
/// Writes a label. Any bit but 0 is 1. A text ends before its first zero, or fills its place.
void store_label(const backend::LabelKind& kind, std::byte* memory, const std::byte* wire);

} // namespace busbar::controller::detail
