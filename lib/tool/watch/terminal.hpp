#pragma once

#include <memory>
#include <optional>

#include "keys.hpp"
#include "screen.hpp"

namespace busbar::tool::watch {

/// The terminal of standard input and output, in full-screen mode as long as this lives. One at a
/// time; whoever writes to it meanwhile garbles it.
///
/// By ncursesw: it knows what each terminal can do (terminfo), tells keys from the bytes that they
/// send, notices new sizes, and sends only what has changed, which counts over a slow line. Debian
/// maintains it in its base system. Ctrl+Z gives the terminal back at the next next_key().
class Terminal {
public:
    /// Null if there is no such terminal: TERM is not known. Without colour styles are told by
    /// brightness alone.
    [[nodiscard]] static std::unique_ptr<Terminal> open(bool has_colour);
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;
    /// Gives the terminal back as it was.
    ~Terminal();

    [[nodiscard]] Size size() const;
    /// What was typed, without waiting. Redraw, too, after the program was stopped.
    [[nodiscard]] std::optional<Key> next_key();
    void draw(const Screen& screen);
    /// Draw all of it the next time, whatever else has written there.
    void forget();

private:
    struct State;
    explicit Terminal(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

} // namespace busbar::tool::watch
