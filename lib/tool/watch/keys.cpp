#include "keys.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace busbar::tool::watch {

namespace {

struct CharacterKey {
    std::string_view character;
    Action action;
};
constexpr std::array character_keys{
    CharacterKey{"q", Action::Quit},     CharacterKey{"p", Action::Pause},
    CharacterKey{" ", Action::Pause},    CharacterKey{"/", Action::Filter},
    CharacterKey{"s", Action::Sort},     CharacterKey{"r", Action::Reverse},
    CharacterKey{"w", Action::Write},    CharacterKey{"e", Action::Events},
    CharacterKey{"d", Action::Details},  CharacterKey{"?", Action::Help},
    CharacterKey{"h", Action::Help},     CharacterKey{"k", Action::Up},
    CharacterKey{"j", Action::Down},     CharacterKey{"g", Action::First},
    CharacterKey{"G", Action::Last},     CharacterKey{"b", Action::PageUp},
    CharacterKey{"f", Action::PageDown},
};

struct SpecialKey {
    Key::Kind kind;
    Action action;
};
constexpr std::array special_keys{
    SpecialKey{Key::Kind::Up, Action::Up},
    SpecialKey{Key::Kind::Down, Action::Down},
    SpecialKey{Key::Kind::PageUp, Action::PageUp},
    SpecialKey{Key::Kind::PageDown, Action::PageDown},
    SpecialKey{Key::Kind::Home, Action::First},
    SpecialKey{Key::Kind::End, Action::Last},
    SpecialKey{Key::Kind::Enter, Action::Write},
    SpecialKey{Key::Kind::Escape, Action::Cancel},
    SpecialKey{Key::Kind::Redraw, Action::Redraw},
};

/// The most important first: the others go where there is no room.
constexpr std::array<std::string_view, 10> help{
    "q quit", "? help",  "w write",  "d details", "/ filter",
    "s sort", "p pause", "e events", "r reverse", "Up Down scroll"};

constexpr std::array<std::string_view, 15> lines{
    "Up, k          the variable above",
    "Down, j        the variable below",
    "Page Up, b     a page up",
    "Page Down, f   a page down",
    "Home, g        the first variable",
    "End, G         the last variable",
    "w, Enter       write the value of the variable",
    "d              show all that is known of the variable, or the table again",
    "/              show only variables whose names contain a text; Escape ends it",
    "s              sort as given, by name, value, age or status",
    "r              reverse the order",
    "p, Space       pause, or go on",
    "e              show events, or not",
    "Ctrl+L         draw the screen again",
    "q, Ctrl+C      end",
};

/// A character of UTF-8 begins with any byte but 10xxxxxx.
bool continues_character(char byte)
{
    return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

} // namespace

Action action_of(const Key& key)
{
    if (key.kind == Key::Kind::Character) {
        const auto* const found =
            std::ranges::find(character_keys, std::string_view{key.text}, &CharacterKey::character);
        return found == character_keys.end() ? Action::None : found->action;
    }
    const auto* const found = std::ranges::find(special_keys, key.kind, &SpecialKey::kind);
    return found == special_keys.end() ? Action::None : found->action;
}

std::string key_help(std::size_t columns)
{
    std::string text;
    for (const std::string_view entry : help) {
        const std::size_t gap = text.empty() ? 0 : 2;
        if (text.size() + gap + entry.size() > columns) {
            break;
        }
        text.append(gap, ' ').append(entry);
    }
    return text;
}

std::vector<std::string> all_key_help()
{
    return {lines.begin(), lines.end()};
}

LineEditor::State LineEditor::take(const Key& key)
{
    switch (key.kind) {
    case Key::Kind::Enter:
        return State::Accepted;
    case Key::Kind::Escape:
        return State::Cancelled;
    case Key::Kind::ClearLine:
        text_.clear();
        break;
    case Key::Kind::Backspace:
        while (!text_.empty() && continues_character(text_.back())) {
            text_.pop_back();
        }
        if (!text_.empty()) {
            text_.pop_back();
        }
        break;
    case Key::Kind::Character:
        if (text_.size() + key.text.size() <= max_bytes) {
            text_ += key.text;
        }
        break;
    default:
        break;
    }
    return State::Editing;
}

} // namespace busbar::tool::watch
