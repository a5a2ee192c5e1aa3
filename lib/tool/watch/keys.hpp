#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace busbar::tool::watch {

/// A key that the user typed.
struct Key {
    enum class Kind : std::uint8_t {
        Character,
        Up,
        Down,
        PageUp,
        PageDown,
        Home,
        End,
        Enter,
        Escape,
        Backspace,
        ClearLine, // Ctrl+U
        Redraw,    // Ctrl+L, or the terminal has another size
    };
    Kind kind{Kind::Character};
    /// UTF-8, for Character alone.
    std::string text{};
};

enum class Action : std::uint8_t {
    None,
    Quit,
    Up,
    Down,
    PageUp,
    PageDown,
    First,
    Last,
    Pause,
    Filter,
    Sort,
    Reverse,
    Write,
    Events,
    Details,
    Help,
    Redraw,
    Cancel, // the details, the filter, or what a message says
};

/// The action of a key while no line is edited.
[[nodiscard]] Action action_of(const Key& key);
/// "q quit  p pause ...": as many as there is room for.
[[nodiscard]] std::string key_help(std::size_t columns);
/// Describes each key on a line.
[[nodiscard]] std::vector<std::string> all_key_help();

/// A line that the user edits at its end.
class LineEditor {
public:
    enum class State : std::uint8_t { Editing, Accepted, Cancelled };
    static constexpr std::size_t max_bytes = 4'096;

    explicit LineEditor(std::string text = {}) : text_{std::move(text)} {}
    State take(const Key& key);
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
};

} // namespace busbar::tool::watch
