#pragma once

namespace busbar::tool::watch {

/// Whether terminfo knows what TERM names. newterm() finds out too, but keeps what it took where it
/// does not. In a file of its own, as <term.h> has macros of names like "tab" and "columns".
[[nodiscard]] bool is_known_terminal();

} // namespace busbar::tool::watch
