#pragma once

namespace busbar::tool::watch {

/// Tells whether terminfo knows the TERM. newterm() would tell, too, but leaks memory for an
/// unknown one. In a file of its own, because <term.h> has macros with names like "tab" and
/// "columns".
[[nodiscard]] bool is_known_terminal();

} // namespace busbar::tool::watch
