#include "terminal.hpp"

#include <array>
#include <climits>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <cwchar>

// Its macros have names like "timeout" and "erase" otherwise.
#define NCURSES_NOMACROS 1
#define NCURSES_WIDECHAR 1
#include <curses.h>

namespace busbar::tool::watch {

namespace {

/// Escape alone is told from the sequences of other keys by the time to the next byte.
constexpr int escape_delay_ms = 25;

struct StyleColour {
    short pair;
    short colour;
};
constexpr std::array colours{
    StyleColour{1, COLOR_GREEN},
    StyleColour{2, COLOR_YELLOW},
    StyleColour{3, COLOR_RED},
};

volatile std::sig_atomic_t is_to_stop = 0;
volatile std::sig_atomic_t was_continued = 0;

void on_stop(int)
{
    is_to_stop = 1;
}

void on_continue(int)
{
    was_continued = 1;
}

using SignalAction = void (*)(int);

/// Takes over Ctrl+Z, which ncurses ignores while it draws, so that some would be lost. It stays
/// ignored if the parent process ignores it. Returns the previous action.
SignalAction take_stops()
{
    const SignalAction before = std::signal(SIGTSTP, on_stop);
    if (before == SIG_IGN) {
        std::signal(SIGTSTP, SIG_IGN);
    }
    return before;
}

/// Gives the terminal back and stops; returns when the program goes on. The next drawing takes the
/// terminal again.
void stop()
{
    is_to_stop = 0;
    def_prog_mode();
    endwin();
    std::signal(SIGTSTP, SIG_DFL);
    static_cast<void>(std::raise(SIGTSTP));
    std::signal(SIGTSTP, on_stop);
}

short pair_of(Style style)
{
    switch (style) {
    case Style::Good:
        return 1;
    case Style::Uncertain:
        return 2;
    case Style::Bad:
        return 3;
    default:
        return 0;
    }
}

attr_t attributes_of(const Ink& ink)
{
    attr_t attributes = A_NORMAL;
    if (ink.style == Style::Bold || ink.style == Style::Bad) {
        attributes |= A_BOLD;
    }
    if (ink.style == Style::Dim) {
        attributes |= A_DIM;
    }
    return ink.is_reversed ? attributes | A_REVERSE : attributes;
}

struct KeyCode {
    wint_t code;
    Key::Kind kind;
};
constexpr std::array function_keys{
    KeyCode{KEY_UP, Key::Kind::Up},         KeyCode{KEY_DOWN, Key::Kind::Down},
    KeyCode{KEY_PPAGE, Key::Kind::PageUp},  KeyCode{KEY_NPAGE, Key::Kind::PageDown},
    KeyCode{KEY_HOME, Key::Kind::Home},     KeyCode{KEY_END, Key::Kind::End},
    KeyCode{KEY_ENTER, Key::Kind::Enter},   KeyCode{KEY_BACKSPACE, Key::Kind::Backspace},
    KeyCode{KEY_RESIZE, Key::Kind::Redraw},
};
constexpr std::array control_keys{
    KeyCode{'\n', Key::Kind::Enter},      KeyCode{'\r', Key::Kind::Enter},
    KeyCode{27, Key::Kind::Escape},       KeyCode{8, Key::Kind::Backspace},
    KeyCode{127, Key::Kind::Backspace},   KeyCode{'U' - 64, Key::Kind::ClearLine},
    KeyCode{'L' - 64, Key::Kind::Redraw},
};

template <std::size_t N>
std::optional<Key> find_key(const std::array<KeyCode, N>& keys, wint_t code)
{
    for (const KeyCode& key : keys) {
        if (key.code == code) {
            return Key{key.kind};
        }
    }
    return std::nullopt;
}

std::optional<Key> character_key(wint_t code)
{
    char bytes[MB_LEN_MAX];
    std::mbstate_t state{};
    const std::size_t size = std::wcrtomb(bytes, static_cast<wchar_t>(code), &state);
    const bool is_printable = code >= ' ' && code != 127 && size != static_cast<std::size_t>(-1);
    return is_printable ? std::optional{Key{Key::Kind::Character, {bytes, size}}} : std::nullopt;
}

/// Returns the glyph in the form of ncurses; a question mark if the locale does not have it.
cchar_t cell_of(const Screen::Glyph& glyph, bool has_colour)
{
    wchar_t wide[CCHARW_MAX + 1] = {};
    const char* bytes = glyph.text.c_str();
    std::mbstate_t state{};
    const std::size_t count = std::mbsrtowcs(wide, &bytes, CCHARW_MAX, &state);
    if (count == static_cast<std::size_t>(-1) || count == 0) {
        wide[0] = L'?';
        wide[1] = L'\0';
    }
    cchar_t cell{};
    const short pair = has_colour ? pair_of(glyph.ink.style) : short{0};
    setcchar(&cell, wide, attributes_of(glyph.ink), pair, nullptr);
    return cell;
}

} // namespace

struct Terminal::State {
    SCREEN* screen;
    bool has_colour;
    SignalAction stop_action; // of the time before
};

std::unique_ptr<Terminal> Terminal::open(bool has_colour)
{
    if (std::setlocale(LC_CTYPE, "") == nullptr) {
        std::setlocale(LC_CTYPE, "C.UTF-8"); // the user's is not installed
    }
    // The terminal knows its size; LINES and COLUMNS do not change with it.
    ::unsetenv("LINES");
    ::unsetenv("COLUMNS");
    if (!is_known_terminal()) {
        return nullptr;
    }
    const SignalAction stop_action = take_stops(); // before ncurses would
    SCREEN* const screen = newterm(nullptr, stdout, stdin);
    if (screen == nullptr) {
        std::signal(SIGTSTP, stop_action);
        return nullptr;
    }
    cbreak();
    noecho();
    nonl();
    std::signal(SIGCONT, on_continue);
    keypad(stdscr, true);
    nodelay(stdscr, true);
    leaveok(stdscr, false);
    set_escdelay(escape_delay_ms);
    has_colour = has_colour && start_color() == OK && use_default_colors() == OK;
    for (const StyleColour& colour : colours) {
        if (has_colour) {
            init_pair(colour.pair, colour.colour, -1);
        }
    }
    return std::unique_ptr<Terminal>{
        new Terminal{std::make_unique<State>(State{screen, has_colour, stop_action})}};
}

Terminal::Terminal(std::unique_ptr<State> state) : state_{std::move(state)} {}

Terminal::~Terminal()
{
    std::signal(SIGCONT, SIG_DFL);
    curs_set(1);
    endwin();
    std::signal(SIGTSTP, state_->stop_action);
    delscreen(state_->screen);
}

Size Terminal::size() const
{
    return {static_cast<std::size_t>(getmaxx(stdscr)), static_cast<std::size_t>(getmaxy(stdscr))};
}

std::optional<Key> Terminal::next_key()
{
    if (is_to_stop != 0) {
        stop();
        was_continued = 1;
    }
    if (was_continued != 0) {
        was_continued = 0;
        reset_prog_mode(); // it was stopped, perhaps by SIGSTOP, which ncurses does not see
        return Key{Key::Kind::Redraw};
    }
    // Keys without a meaning here are ignored.
    for (;;) {
        wint_t code = 0;
        const int kind = get_wch(&code);
        if (kind == ERR) {
            return std::nullopt;
        }
        auto key =
            kind == KEY_CODE_YES ? find_key(function_keys, code) : find_key(control_keys, code);
        if (!key && kind == OK) {
            key = character_key(code);
        }
        if (key) {
            return key;
        }
    }
}

void Terminal::draw(const Screen& screen)
{
    werase(stdscr);
    for (std::size_t row = 0; row < screen.size().rows; ++row) {
        for (std::size_t column = 0; column < screen.size().columns; ++column) {
            const Screen::Glyph& glyph = screen.at(row, column);
            if (!glyph.text.empty()) {
                const cchar_t cell = cell_of(glyph, state_->has_colour);
                mvwadd_wch(stdscr, static_cast<int>(row), static_cast<int>(column), &cell);
            }
        }
    }
    curs_set(screen.cursor ? 1 : 0);
    if (screen.cursor) {
        wmove(stdscr, static_cast<int>(screen.cursor->row),
              static_cast<int>(screen.cursor->column));
    }
    wrefresh(stdscr);
}

void Terminal::forget()
{
    clearok(stdscr, true);
}

} // namespace busbar::tool::watch
