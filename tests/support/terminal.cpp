#include "support/terminal.hpp"

#include <stdexcept>
#include <thread>

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

namespace busbar::test {

namespace {

constexpr std::chrono::milliseconds short_while{20};

winsize window_of(TerminalSize size)
{
    winsize window{};
    window.ws_col = static_cast<unsigned short>(size.columns);
    window.ws_row = static_cast<unsigned short>(size.rows);
    return window;
}

} // namespace

Terminal::Terminal(const TerminalProgram& program) : screen_{program.size}
{
    std::vector<std::string> arguments = program.command;
    std::vector<std::string> variables =
        variables_of(program.environment, {{"TERM", "xterm-256color"}, {"LC_ALL", "C.UTF-8"}});
    const std::vector<char*> argument_list = pointers_to(arguments);
    const std::vector<char*> variable_list = pointers_to(variables);
    const winsize window = window_of(program.size);
    program_ = ::forkpty(&terminal_, nullptr, nullptr, &window);
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
        ::waitpid(program_, nullptr, 0);
    }
    hang_up();
}

bool Terminal::take()
{
    pollfd waiting{terminal_, POLLIN, 0};
    if (!is_open_ || ::poll(&waiting, 1, static_cast<int>(short_while.count())) <= 0) {
        return is_open_;
    }
    char block[4'096];
    const ::ssize_t size = ::read(terminal_, block, sizeof block);
    if (size <= 0) { // EIO when nobody has it open on the other side
        is_open_ = false;
        return false;
    }
    write(screen_.take({block, static_cast<std::size_t>(size)}));
    return is_open_;
}

bool Terminal::wait_until(const std::function<bool()>& is_wanted)
{
    const auto end = std::chrono::steady_clock::now() + patience;
    while (!is_wanted()) {
        if (!take() || std::chrono::steady_clock::now() >= end) {
            return is_wanted();
        }
    }
    return true;
}

bool Terminal::wait_for(std::string_view text)
{
    return wait_until([this, text] { return !screen_.row_with(text).empty(); });
}

bool Terminal::reap()
{
    int status = 0;
    if (::waitpid(program_, &status, WNOHANG) != program_) {
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
        if (!take() && !reap()) {
            std::this_thread::sleep_for(short_while);
        }
    }
    return status_;
}

void Terminal::type(std::string_view keys)
{
    write(keys);
    if (!is_open_) {
        throw std::runtime_error{"the terminal takes no keys"};
    }
}

void Terminal::write(std::string_view bytes)
{
    while (is_open_ && !bytes.empty()) {
        const ::ssize_t size = ::write(terminal_, bytes.data(), bytes.size());
        is_open_ = size > 0;
        bytes.remove_prefix(is_open_ ? static_cast<std::size_t>(size) : 0);
    }
}

void Terminal::resize(TerminalSize size)
{
    screen_.resize(size);
    const winsize window = window_of(size);
    ::ioctl(terminal_, TIOCSWINSZ, &window);
}

void Terminal::signal(int number)
{
    ::kill(program_, number);
}

bool Terminal::takes_lines() const
{
    termios modes{};
    return ::tcgetattr(terminal_, &modes) == 0 && (modes.c_lflag & ICANON) != 0 &&
           (modes.c_iflag & ICRNL) != 0;
}

void Terminal::take_over(std::string_view text)
{
    while (::waitpid(program_, nullptr, WUNTRACED) != program_) {
    }
    termios modes{};
    ::tcgetattr(terminal_, &modes);
    modes.c_lflag |= static_cast<tcflag_t>(ECHO | ICANON);
    ::tcsetattr(terminal_, TCSANOW, &modes);
    write(screen_.take(text));
}

void Terminal::hang_up()
{
    if (terminal_ >= 0) {
        ::close(terminal_);
    }
    terminal_ = -1;
    is_open_ = false;
}

} // namespace busbar::test
