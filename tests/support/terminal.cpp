#include "support/terminal.hpp"

#include <cstdlib>
#include <stdexcept>

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

extern "C" {
#include <vterm.h>
}

namespace busbar::test {

namespace {

winsize size_of(std::size_t columns, std::size_t rows)
{
    winsize size{};
    size.ws_col = static_cast<unsigned short>(columns);
    size.ws_row = static_cast<unsigned short>(rows);
    return size;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts)
{
    std::vector<char*> pointers;
    for (std::string& text : texts) {
        pointers.push_back(text.data());
    }
    pointers.push_back(nullptr);
    return pointers;
}

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

struct Terminal::Screen {
    Screen(std::size_t columns, std::size_t rows)
        : terminal{vterm_new(static_cast<int>(rows), static_cast<int>(columns)), vterm_free},
          screen{vterm_obtain_screen(terminal.get())}
    {
        vterm_set_utf8(terminal.get(), 1);
        vterm_screen_enable_altscreen(screen, 1);
        vterm_screen_reset(screen, 1);
    }
    [[nodiscard]] std::pair<std::size_t, std::size_t> size() const // columns, rows
    {
        int rows = 0;
        int columns = 0;
        vterm_get_size(terminal.get(), &rows, &columns);
        return {static_cast<std::size_t>(columns), static_cast<std::size_t>(rows)};
    }
    [[nodiscard]] VTermScreenCell cell(std::size_t row, std::size_t column) const
    {
        VTermScreenCell cell{};
        vterm_screen_get_cell(screen, {static_cast<int>(row), static_cast<int>(column)}, &cell);
        return cell;
    }

    std::unique_ptr<VTerm, void (*)(VTerm*)> terminal;
    VTermScreen* screen;
};

Terminal::Terminal(const TerminalProgram& program)
    : screen_{std::make_unique<Screen>(program.columns, program.rows)}
{
    std::vector<std::string> arguments = program.command;
    const char* const path = std::getenv("PATH");
    std::vector<std::string> variables{"TERM=xterm-256color", "LC_ALL=C.UTF-8",
                                       std::string{"PATH="} + (path == nullptr ? "" : path)};
    for (const auto& [name, value] : program.environment) {
        variables.push_back(name + "=" + value);
    }
    const std::vector<char*> argument_list = pointers_to(arguments);
    const std::vector<char*> variable_list = pointers_to(variables);
    winsize size = size_of(program.columns, program.rows);
    program_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (program_ < 0) {
        throw std::runtime_error{"there is no pseudo-terminal"};
    }
    if (program_ == 0) {
        ::execve(argument_list[0], argument_list.data(), variable_list.data());
        ::_exit(127);
    }
}

Terminal::~Terminal()
{
    if (!status_) {
        ::kill(program_, SIGKILL);
        reap(true);
    }
    ::close(terminal_);
}

bool Terminal::take()
{
    pollfd waiting{terminal_, POLLIN, 0};
    constexpr int short_while_ms = 50;
    if (!is_open_ || ::poll(&waiting, 1, short_while_ms) <= 0) {
        return is_open_;
    }
    char block[4'096];
    const ::ssize_t size = ::read(terminal_, block, sizeof block);
    if (size <= 0) { // EIO when nobody has it open on the other side
        is_open_ = false;
        return false;
    }
    const auto count = static_cast<std::size_t>(size);
    written_.append(block, count);
    vterm_input_write(screen_->terminal.get(), block, count);
    return true;
}

bool Terminal::wait_until(const std::function<bool(const Terminal&)>& is_wanted)
{
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!is_wanted(*this)) {
        if (!take() || std::chrono::steady_clock::now() >= end) {
            return is_wanted(*this);
        }
    }
    return true;
}

bool Terminal::wait_for(std::string_view text)
{
    return wait_until([text](const Terminal& terminal) {
        for (const std::string& row : terminal.screen()) {
            if (row.find(text) != std::string::npos) {
                return true;
            }
        }
        return false;
    });
}

bool Terminal::reap(bool waits)
{
    int status = 0;
    if (::waitpid(program_, &status, waits ? 0 : WNOHANG) != program_) {
        return false;
    }
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return true;
}

std::optional<int> Terminal::wait_for_end()
{
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!status_ && std::chrono::steady_clock::now() < end) {
        // Not before all is taken: what a dead program wrote last is part of the screen.
        if (!take()) {
            reap(true);
        }
    }
    return status_;
}

void Terminal::send(std::string_view keys)
{
    while (!keys.empty()) {
        const ::ssize_t size = ::write(terminal_, keys.data(), keys.size());
        if (size <= 0) {
            throw std::runtime_error{"the terminal takes no keys"};
        }
        keys.remove_prefix(static_cast<std::size_t>(size));
    }
}

void Terminal::resize(std::size_t columns, std::size_t rows)
{
    vterm_set_size(screen_->terminal.get(), static_cast<int>(rows), static_cast<int>(columns));
    const winsize size = size_of(columns, rows);
    ::ioctl(terminal_, TIOCSWINSZ, &size);
}

std::string Terminal::row(std::size_t index) const
{
    const std::size_t columns = screen_->size().first;
    std::string text;
    for (std::size_t column = 0; column < columns; ++column) {
        const VTermScreenCell cell = screen_->cell(index, column);
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

std::vector<std::string> Terminal::screen() const
{
    std::vector<std::string> rows;
    for (std::size_t i = 0; i < screen_->size().second; ++i) {
        rows.push_back(row(i));
    }
    return rows;
}

std::string Terminal::text() const
{
    std::string text;
    std::string empty;
    for (const std::string& row : screen()) {
        empty += '\n';
        if (!row.empty()) {
            text += empty.substr(1) + row + "\n";
            empty.clear();
        }
    }
    return text;
}

bool Terminal::is_bold(std::size_t row, std::size_t column) const
{
    return screen_->cell(row, column).attrs.bold != 0;
}

std::pair<std::size_t, std::size_t> Terminal::cursor() const
{
    VTermPos position{};
    vterm_state_get_cursorpos(vterm_obtain_state(screen_->terminal.get()), &position);
    return {static_cast<std::size_t>(position.row), static_cast<std::size_t>(position.col)};
}

} // namespace busbar::test
