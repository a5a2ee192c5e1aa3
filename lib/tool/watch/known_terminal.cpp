#include "terminal.hpp"

#include <curses.h>
#include <term.h>
#include <unistd.h>

namespace busbar::tool::watch {

// In a file of its own, because <term.h> has macros with names like "tab" and "columns".
bool is_known_terminal()
{
    int error = 0;
    if (::setupterm(nullptr, STDOUT_FILENO, &error) != OK) {
        return false;
    }
    ::del_curterm(cur_term);
    return true;
}

} // namespace busbar::tool::watch
