#pragma once

#include <cstdlib>

namespace busbar::fuzz {

/// Ends the program, which the fuzzer keeps the input of.
inline void require(bool is_right)
{
    if (!is_right) {
        std::abort();
    }
}

} // namespace busbar::fuzz
