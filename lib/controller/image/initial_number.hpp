#pragma once

#include <cstddef>
#include <optional>

#include <busbar/controller/program.hpp>

namespace busbar::controller::detail {

/// Puts a number, truth value or date as `type` has it to where a value of that type lies. False,
/// with nothing changed, if it has none: another kind of value, or one that is too large.
[[nodiscard]] bool put_initial_number(BuiltInType type, const Variant& value, std::byte* to);

/// What a number of a program's is as values of `built_in` have it: milliseconds of a TIME rounded,
/// a TIME_OF_DAY as milliseconds since midnight. Others, and what cannot be, stay as they are.
[[nodiscard]] Variant as_published(ElementaryType type, BuiltInType built_in, const Variant& value);

/// True also for what is no integer.
[[nodiscard]] bool is_in_subrange(const Variant& value, const std::optional<Bounds>& subrange);

} // namespace busbar::controller::detail
