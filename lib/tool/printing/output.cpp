#include "output.hpp"

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <optional>

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "tool/connection/failure.hpp"

namespace busbar::tool {

namespace {

std::string_view environment(const char* name)
{
    const char* const text = std::getenv(name);
    return text == nullptr ? std::string_view{} : std::string_view{text};
}

bool is_utf8_locale()
{
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        if (const std::string_view value = environment(name); !value.empty()) {
            return value.find("UTF-8") != std::string_view::npos ||
                   value.find("utf8") != std::string_view::npos;
        }
    }
    return false;
}

std::optional<winsize> size_of(std::FILE* file)
{
    winsize size{};
    if (::ioctl(::fileno(file), TIOCGWINSZ, &size) != 0) {
        return std::nullopt;
    }
    return size;
}

std::string_view code_of(Style style)
{
    switch (style) {
    case Style::Bold:
        return "\x1b[1m";
    case Style::Dim:
        return "\x1b[2m";
    case Style::Good:
        return "\x1b[32m";
    case Style::Uncertain:
        return "\x1b[33m";
    case Style::Bad:
        return "\x1b[31m";
    case Style::Plain:
        break;
    }
    return "";
}

/// 0, or the errno of what went wrong.
int write_all(int file, std::string_view text)
{
    while (!text.empty()) {
        const ::ssize_t size = ::write(file, text.data(), text.size());
        if (size >= 0) {
            text.remove_prefix(static_cast<std::size_t>(size));
        } else if (errno == EAGAIN) { // another process made the terminal or pipe non-blocking
            ::pollfd waiting{file, POLLOUT, 0};
            ::poll(&waiting, 1, -1);
        } else if (errno != EINTR) {
            return errno;
        }
    }
    return 0;
}

} // namespace

Output::Output(std::FILE* file)
    : file_{file}, is_terminal_{::isatty(::fileno(file)) == 1},
      has_colour_{is_terminal_ && environment("NO_COLOR").empty() && environment("TERM") != "dumb"},
      has_unicode_{is_utf8_locale()}
{
}

std::size_t Output::columns() const
{
    if (const auto size = is_terminal_ ? size_of(file_) : std::nullopt) {
        return size->ws_col == 0 ? 80 : size->ws_col;
    }
    const std::string_view text = environment("COLUMNS");
    std::size_t columns = 0;
    std::from_chars(text.data(), text.data() + text.size(), columns);
    return columns < 20 ? SIZE_MAX : columns;
}

std::size_t Output::rows() const
{
    const auto size = is_terminal_ ? size_of(file_) : std::nullopt;
    return !size ? SIZE_MAX : size->ws_row == 0 ? 24 : size->ws_row;
}

void Output::write(std::string_view text)
{
    const int error = write_all(::fileno(file_), text);
    if (error == 0 || ::fileno(file_) == STDERR_FILENO) {
        return;
    }
    if (error == EPIPE) {
        throw OutputClosed{};
    }
    throw Failure{Exit::Failed,
                  std::string{"the output cannot be written: "} + std::strerror(error)};
}

std::string Output::styled(Style style, std::string_view text) const
{
    if (!has_colour_ || style == Style::Plain || text.empty()) {
        return std::string{text};
    }
    return std::string{code_of(style)}.append(text).append("\x1b[0m");
}

} // namespace busbar::tool
