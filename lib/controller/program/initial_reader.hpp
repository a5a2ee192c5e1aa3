#pragma once

#include <cstddef>
#include <cstdint>

#include "declaration_cursor.hpp"

namespace busbar::controller::detail {

/// What stands behind `:=`: a constant, an aggregate `(X := 1)` or a list `[1, 2(0)]`. `value` has
/// its member and repetition already. False with a problem at the cursor.
[[nodiscard]] BUSBAR_API bool read_initial_value(DeclarationCursor& cursor, InitialValue& value,
                                                 std::size_t depth = 0);

/// A whole number with or without a sign; `what` is expected.
[[nodiscard]] BUSBAR_API bool read_whole_number(DeclarationCursor& cursor, std::int64_t& number,
                                                std::string_view what);

} // namespace busbar::controller::detail
