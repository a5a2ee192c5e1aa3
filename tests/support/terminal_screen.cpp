#include "support/terminal_screen.hpp"

#include <cstdint>

extern "C" {
#include <vterm.h>
}

namespace busbar::test {

namespace {

void append_utf8(std::string& text, std::uint32_t character)
{
    const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    if (character < 0x80) {
        add(character);
    } else if (character < 0x800) {
        add(0xC0 | character >> 6U);
        add(0x80 | (character & 0x3F));
    } else if (character < 0x10000) {
        add(0xE0 | character >> 12U);
        add(0x80 | (character >> 6U & 0x3F));
        add(0x80 | (character & 0x3F));
    } else {
        add(0xF0 | character >> 18U);
        add(0x80 | (character >> 12U & 0x3F));
        add(0x80 | (character >> 6U & 0x3F));
        add(0x80 | (character & 0x3F));
    }
}

} // namespace

struct TerminalScreen::State {
    explicit State(TerminalSize size)
        : terminal{vterm_new(static_cast<int>(size.rows), static_cast<int>(size.columns)),
                   vterm_free},
          screen{vterm_obtain_screen(terminal.get())}
    {
        vterm_set_utf8(terminal.get(), 1);
        callbacks.settermprop = [](VTermProp property, VTermValue* value, void* user) {
            static_cast<State*>(user)->set(property, *value);
            return 1;
        };
        vterm_screen_set_callbacks(screen, &callbacks, this);
        vterm_screen_enable_altscreen(screen, 1);
        vterm_screen_reset(screen, 1);
    }
    void set(VTermProp property, const VTermValue& value)
    {
        if (property == VTERM_PROP_CURSORVISIBLE) {
            is_cursor_visible = value.boolean != 0;
        } else if (property == VTERM_PROP_ALTSCREEN) {
            is_alternate = value.boolean != 0;
        }
    }
    [[nodiscard]] VTermScreenCell cell(std::size_t row, std::size_t column) const
    {
        VTermScreenCell cell{};
        vterm_screen_get_cell(screen, {static_cast<int>(row), static_cast<int>(column)}, &cell);
        return cell;
    }

    std::unique_ptr<VTerm, void (*)(VTerm*)> terminal;
    VTermScreen* screen;
    VTermScreenCallbacks callbacks{};
    bool is_cursor_visible{true};
    bool is_alternate{false};
};

TerminalScreen::TerminalScreen(TerminalSize size) : state_{std::make_unique<State>(size)} {}

TerminalScreen::~TerminalScreen() = default;

std::string TerminalScreen::take(std::string_view bytes)
{
    VTerm* const terminal = state_->terminal.get();
    vterm_input_write(terminal, bytes.data(), bytes.size());
    std::string answer(vterm_output_get_buffer_current(terminal), '\0');
    answer.resize(vterm_output_read(terminal, answer.data(), answer.size()));
    return answer;
}

void TerminalScreen::resize(TerminalSize size)
{
    vterm_set_size(state_->terminal.get(), static_cast<int>(size.rows),
                   static_cast<int>(size.columns));
}

TerminalSize TerminalScreen::size() const
{
    int rows = 0;
    int columns = 0;
    vterm_get_size(state_->terminal.get(), &rows, &columns);
    return {static_cast<std::size_t>(columns), static_cast<std::size_t>(rows)};
}

std::string TerminalScreen::row(std::size_t index) const
{
    std::string text;
    for (std::size_t column = 0; column < size().columns; ++column) {
        const VTermScreenCell cell = state_->cell(index, column);
        if (cell.chars[0] == UINT32_MAX) {
            continue; // the right half of a wide character
        }
        if (cell.chars[0] == 0) {
            text += ' ';
        }
        for (std::size_t i = 0; i < VTERM_MAX_CHARS_PER_CELL && cell.chars[i] != 0; ++i) {
            append_utf8(text, cell.chars[i]);
        }
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

std::vector<std::string> TerminalScreen::rows() const
{
    std::vector<std::string> rows;
    for (std::size_t i = 0; i < size().rows; ++i) {
        rows.push_back(row(i));
    }
    return rows;
}

std::string TerminalScreen::row_with(std::string_view text) const
{
    for (const std::string& row : rows()) {
        if (row.find(text) != std::string::npos) {
            return row;
        }
    }
    return {};
}

std::string TerminalScreen::text() const
{
    std::string text;
    std::string empty;
    for (const std::string& row : rows()) {
        empty += '\n';
        if (!row.empty()) {
            text += empty.substr(1) + row + "\n";
            empty.clear();
        }
    }
    return text;
}

bool TerminalScreen::is_reversed(std::size_t row, std::size_t column) const
{
    return state_->cell(row, column).attrs.reverse != 0;
}

bool TerminalScreen::has_colours() const
{
    for (std::size_t row = 0; row < size().rows; ++row) {
        for (std::size_t column = 0; column < size().columns; ++column) {
            const VTermScreenCell cell = state_->cell(row, column);
            if (!VTERM_COLOR_IS_DEFAULT_FG(&cell.fg)) {
                return true;
            }
        }
    }
    return false;
}

bool TerminalScreen::is_cursor_visible() const
{
    return state_->is_cursor_visible;
}

bool TerminalScreen::is_alternate() const
{
    return state_->is_alternate;
}

} // namespace busbar::test
