#pragma once

#include <busbar/core/expected.hpp>

#include <busbar/core/status_code.hpp>
#include <busbar/core/status_codes.hpp>

namespace busbar {

/// A value or the StatusCode that says why there is none. The status is never Good.
template <typename T>
using Result = Expected<T, StatusCode>;

/// `return fail(status::Bad_DecodingError);` in a function that returns a Result.
[[nodiscard]] constexpr Unexpected<StatusCode> fail(StatusCode code)
{
    return Unexpected<StatusCode>{code};
}

} // namespace busbar
