#pragma once

#include <stdexcept>

namespace busbar::test {

/// What a user's callback that is broken does.
inline void throw_if(bool is_broken)
{
    if (is_broken) {
        throw std::runtime_error{"bus error"};
    }
}

} // namespace busbar::test
