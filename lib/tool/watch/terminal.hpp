#pragma once

#include <memory>
#include <optional>

#include "keys.hpp"
#include "screen.hpp"

namespace busbar::tool::watch {

/// The terminal of standard input and output, in full-screen mode while this object exists. Only
/// one may exist; other output to the terminal in the meantime garbles it.
///
/// Uses ncursesw: it knows the abilities of each terminal (terminfo), recognizes keys by their
/// bytes, notices new sizes, and sends only what has changed, which matters on a slow line. Debian
/// maintains it in its base system. Ctrl+Z gives the terminal back at the next next_key().
class Terminal {
public:
    /// Null if TERM is not a known terminal. Without colour, styles differ only in
    /// brightness.
    [[nodiscard]] static std::unique_ptr<Terminal> open(bool has_colour);
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    /// Gives the terminal back as it was.
    ~Terminal();

    [[nodiscard]] Size size() const;
    /// Returns the next key without waiting. Redraw, too, after the program was stopped.
    [[nodiscard]] std::optional<Key> next_key();
    void draw(const Screen& screen);
    /// Draw all of it the next time, whatever else has written there.
    void forget();

private:
    struct State;
    explicit Terminal(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// Tells whether terminfo knows the TERM. newterm() would tell, too, but leaks memory for an
/// unknown one.
[[nodiscard]] bool is_known_terminal();

} // namespace busbar::tool::watch
