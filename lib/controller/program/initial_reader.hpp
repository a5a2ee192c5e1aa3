#pragma once

#include <cstddef>
#include <cstdint>

#include "declaration_cursor.hpp"

namespace busbar::controller::detail {

/// Reads the value after `:=`: an expression, an aggregate `(X := 1)` or a list `[1, 2(0)]`. The
/// member and the repetition of `value` are already set. Gives false after reporting a problem at
/// the cursor.
[[nodiscard]] BUSBAR_API bool read_initial_value(DeclarationCursor& cursor, InitialValue& value,
                                                 std::size_t depth = 0);

/// Reads an expression whose value is an integer; otherwise reports that `what` was expected.
/// Leaves `number` alone if the value is not known yet.
[[nodiscard]] BUSBAR_API bool read_whole_number(DeclarationCursor& cursor, std::int64_t& number,
                                                std::string_view what);

} // namespace busbar::controller::detail
