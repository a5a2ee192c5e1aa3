#pragma once

#include <cstddef>

#include <busbar/backend/label.hpp>

/// A label's value between a program's memory, laid out as an image has it, and the bytes of a
/// request. Neither allocates; `wire` has backend::size_of(kind) bytes.
namespace busbar::controller::detail {

/// TIMEs are rounded to milliseconds and end at what 32 bits can have; behind a text come zeros.
void load_label(const backend::LabelKind& kind, const std::byte* memory, std::byte* wire);
/// Any bit but 0 is 1. A text ends before its first zero, or has all characters that it can.
void store_label(const backend::LabelKind& kind, std::byte* memory, const std::byte* wire);

} // namespace busbar::controller::detail
