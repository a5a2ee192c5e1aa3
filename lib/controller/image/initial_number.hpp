#pragma once

#include <cstddef>
#include <optional>

#include <busbar/controller/program.hpp>

namespace busbar::controller::detail {

/// Stores a number, truth value or date as a value of `type`. False, with nothing changed, if the
/// value is of another kind or does not fit.
[[nodiscard]] bool put_initial_number(BuiltInType type, const Variant& value, std::byte* to);

/// Converts a number of a program to values of type `built_in`: milliseconds of a TIME are rounded,
/// a TIME_OF_DAY becomes milliseconds since midnight. Other values, and those that cannot be
/// converted, stay as they are.
[[nodiscard]] Variant as_published(ElementaryType type, BuiltInType built_in, const Variant& value);

/// True also for values that are not integers.
[[nodiscard]] bool is_in_subrange(const Variant& value, const std::optional<Bounds>& subrange);

} // namespace busbar::controller::detail
