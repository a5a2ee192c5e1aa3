#pragma once

#include <busbar/core/api.hpp>

namespace busbar {

/// Returns the version of the library that a program runs with, as "0.1.0". A program that was
/// compiled with the headers of another one may compare it with what its build found.
[[nodiscard]] BUSBAR_API const char* version() noexcept;

} // namespace busbar
