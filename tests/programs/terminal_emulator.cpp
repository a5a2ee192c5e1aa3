#include "terminal_emulator.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <stdexcept>

#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vterm.h>

namespace busbar::test {

namespace {

// The machine may be busy with other things.
constexpr auto patience = std::chrono::minutes{2};

::winsize window(TerminalEmulator::Size size)
{
    ::winsize result{};
    result.ws_col = static_cast<unsigned short>(size.columns);
    result.ws_row = static_cast<unsigned short>(size.rows);
    return result;
}

/// In the child: nothing of the one who tests shall matter but PATH.
[[noreturn]] void run(const std::vector<std::string>& command,
                      const std::vector<std::string>& variables)
{
    for (const char* name : {"NO_COLOR", "LC_ALL", "LC_CTYPE", "BUSBAR_URL", "COLUMNS", "LINES"}) {
        ::unsetenv(name);
    }
    ::setenv("TERM", "xterm-256color", 1);
    ::setenv("LANG", "C.UTF-8", 1);
    for (const std::string& variable : variables) {
        const std::size_t equals = variable.find('=');
        ::setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
    }
    std::vector<char*> arguments;
    for (const std::string& argument : command) {
        arguments.push_back(const_cast<char*>(argument.c_str()));
    }
    arguments.push_back(nullptr);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
}

void append_utf8(std::string& text, std::uint32_t character)
{
    if (character < 0x80) {
        text += static_cast<char>(character);
    } else if (character < 0x800) {
        text += static_cast<char>(0xC0U | (character >> 6U));
        text += static_cast<char>(0x80U | (character & 0x3FU));
    } else {
        if (character >= 0x10000) {
            text += static_cast<char>(0xF0U | (character >> 18U));
            text += static_cast<char>(0x80U | ((character >> 12U) & 0x3FU));
        } else {
            text += static_cast<char>(0xE0U | (character >> 12U));
        }
        text += static_cast<char>(0x80U | ((character >> 6U) & 0x3FU));
        text += static_cast<char>(0x80U | (character & 0x3FU));
    }
}

} // namespace

struct TerminalEmulator::Impl {
    explicit Impl(Size shape) : size{shape}, terminal{::vterm_new(shape.rows, shape.columns)}
    {
        ::vterm_set_utf8(terminal, 1);
        screen = ::vterm_obtain_screen(terminal);
        callbacks.settermprop = [](VTermProp property, VTermValue* value, void* user) {
            static_cast<Impl*>(user)->take(property, *value);
            return 1;
        };
        ::vterm_screen_set_callbacks(screen, &callbacks, this);
        ::vterm_screen_enable_altscreen(screen, 1);
        ::vterm_screen_reset(screen, 1);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl()
    {
        if (!status) {
            ::kill(process, SIGKILL);
            ::waitpid(process, nullptr, 0);
        }
        ::close(descriptor);
        ::vterm_free(terminal);
    }
    void take(VTermProp property, const VTermValue& value)
    {
        if (property == VTERM_PROP_CURSORVISIBLE) {
            is_cursor_visible = value.boolean != 0;
        } else if (property == VTERM_PROP_ALTSCREEN) {
            is_alternate = value.boolean != 0;
        }
    }
    /// Shows what comes within 20 ms.
    void step()
    {
        ::pollfd input{descriptor, POLLIN, 0};
        char bytes[4096];
        const bool has_more = ::poll(&input, 1, 20) > 0;
        const ssize_t count = has_more ? ::read(descriptor, bytes, sizeof bytes) : 0;
        if (count > 0) {
            ::vterm_input_write(terminal, bytes, static_cast<std::size_t>(count));
            const std::size_t answer = ::vterm_output_read(terminal, bytes, sizeof bytes);
            is_open = answer == 0 || ::write(descriptor, bytes, answer) >= 0;
        } else if (count < 0) {
            is_open = false; // the other side was closed
        }
        int code = 0;
        if (!status && ::waitpid(process, &code, WNOHANG) == process) {
            status = code;
        }
    }
    [[nodiscard]] VTermScreenCell cell(int row, int column) const
    {
        VTermScreenCell cell{};
        ::vterm_screen_get_cell(screen, {row, column}, &cell);
        return cell;
    }

    Size size;
    VTerm* terminal;
    VTermScreen* screen{nullptr};
    VTermScreenCallbacks callbacks{};
    bool is_cursor_visible{true};
    bool is_alternate{false};
    bool is_open{true};
    int descriptor{-1};
    ::pid_t process{-1};
    std::optional<int> status;
};

TerminalEmulator::TerminalEmulator(std::vector<std::string> command, Size size,
                                   std::vector<std::string> variables)
    : impl_{std::make_unique<Impl>(size)}
{
    const ::winsize shape = window(size);
    impl_->process = ::forkpty(&impl_->descriptor, nullptr, nullptr, &shape);
    if (impl_->process == 0) {
        run(command, variables);
    }
    if (impl_->process < 0) {
        impl_->status = -1;
        throw std::runtime_error{"no pseudo-terminal"};
    }
}

TerminalEmulator::~TerminalEmulator() = default;

void TerminalEmulator::type(const std::string& bytes)
{
    if (::write(impl_->descriptor, bytes.data(), bytes.size()) !=
        static_cast<ssize_t>(bytes.size())) {
        throw std::runtime_error{"the program does not take what is typed"};
    }
}

void TerminalEmulator::resize(Size size)
{
    impl_->size = size;
    ::vterm_set_size(impl_->terminal, size.rows, size.columns);
    const ::winsize shape = window(size);
    ::ioctl(impl_->descriptor, TIOCSWINSZ, &shape);
}

void TerminalEmulator::signal(int number)
{
    ::kill(impl_->process, number);
}

bool TerminalEmulator::wait_until(const std::function<bool()>& holds)
{
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!holds()) {
        if (!impl_->is_open || std::chrono::steady_clock::now() > end) {
            return false;
        }
        impl_->step();
    }
    return true;
}

bool TerminalEmulator::wait_for(const std::string& text)
{
    return wait_until([&] {
        const auto shown = lines();
        return std::any_of(shown.begin(), shown.end(), [&](const std::string& line) {
            return line.find(text) != std::string::npos;
        });
    });
}

int TerminalEmulator::wait_for_exit()
{
    static_cast<void>(wait_until([this] { return !impl_->is_open; }));
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!impl_->status && std::chrono::steady_clock::now() < end) {
        impl_->step();
    }
    return impl_->status && WIFEXITED(*impl_->status) ? WEXITSTATUS(*impl_->status) : -1;
}

TerminalEmulator::Size TerminalEmulator::size() const
{
    return impl_->size;
}

std::string TerminalEmulator::line(int row) const
{
    std::string text;
    for (int column = 0; column < impl_->size.columns;) {
        const VTermScreenCell cell = impl_->cell(row, column);
        if (cell.chars[0] == 0) {
            text += ' ';
        }
        for (int i = 0; i < VTERM_MAX_CHARS_PER_CELL && cell.chars[i] != 0; ++i) {
            append_utf8(text, cell.chars[i]);
        }
        column += std::max<int>(cell.width, 1);
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

std::vector<std::string> TerminalEmulator::lines() const
{
    std::vector<std::string> all;
    for (int row = 0; row < impl_->size.rows; ++row) {
        all.push_back(line(row));
    }
    return all;
}

bool TerminalEmulator::is_reversed(int row, int column) const
{
    return impl_->cell(row, column).attrs.reverse != 0;
}

bool TerminalEmulator::has_colours() const
{
    for (int row = 0; row < impl_->size.rows; ++row) {
        for (int column = 0; column < impl_->size.columns; ++column) {
            const VTermScreenCell cell = impl_->cell(row, column);
            if (!VTERM_COLOR_IS_DEFAULT_FG(&cell.fg)) {
                return true;
            }
        }
    }
    return false;
}

bool TerminalEmulator::is_cursor_visible() const
{
    return impl_->is_cursor_visible;
}

bool TerminalEmulator::is_alternate() const
{
    return impl_->is_alternate;
}

} // namespace busbar::test
