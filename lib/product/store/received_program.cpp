#include "received_program.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <span>
#include <utility>

#include "controller/life/checksum.hpp"
#include "core/utf8.hpp"

namespace busbar::product {

namespace {

constexpr std::size_t max_name = 255;

/// Takes a line, without its end, off the front of `rest`; nothing if there is none.
std::optional<std::string_view> take_line(std::string_view& rest)
{
    const std::size_t end = rest.find('\n');
    if (end == std::string_view::npos) {
        return std::nullopt;
    }
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    return line;
}

/// Replaces line breaks: a user's name may be any text.
std::string in_one_line(std::string text)
{
    for (char& each : text) {
        each = each == '\n' ? ' ' : each;
    }
    return text;
}

std::optional<DateTime> time_in(std::string_view line)
{
    std::int64_t ticks = 0;
    const char* const end = line.data() + line.size();
    const auto read = std::from_chars(line.data(), end, ticks);
    return read.ec == std::errc{} && read.ptr == end ? std::optional{DateTime{ticks}}
                                                     : std::nullopt;
}

} // namespace

bool is_program_name(std::string_view name)
{
    return name.size() <= max_name && detail::is_name(name) &&
           name.find_first_of("/\\") == std::string_view::npos;
}

std::string document_of(const ReceivedProgram& program)
{
    const std::string content = program.name + "\n" + in_one_line(program.user) + "\n" +
                                std::to_string(program.time.ticks) + "\n" + program.text;
    return controller::detail::checksum_text(content) + "\n" + content;
}

Configured<ReceivedProgram> read_received(std::string_view document, const std::string& place)
{
    std::string_view rest = document;
    const auto sum = take_line(rest);
    if (!sum || *sum != controller::detail::checksum_text(rest)) {
        return misconfigured(place, "the program that was received is damaged");
    }
    std::array<std::string_view, 3> lines;
    for (std::string_view& line : lines) {
        line = take_line(rest).value_or(std::string_view{});
    }
    const auto time = time_in(lines[2]);
    if (!is_program_name(lines[0]) || !time || rest.size() > ReceivedProgram::max_text) {
        return misconfigured(place, "is not a program that was received");
    }
    return ReceivedProgram{std::string{lines[0]}, std::string{lines[1]}, *time, std::string{rest}};
}

Configured<void> keep_received(Storage& storage, const std::optional<std::string>& document)
{
    const auto name = ReceivedProgram::file_name;
    const auto done =
        document ? storage.replace(name, std::as_bytes(std::span{*document}), FileAccess::Owner)
                 : storage.remove(name);
    if (done || (!document && done.error() == StorageError::NotFound)) {
        return {};
    }
    return misconfigured(storage.place(name), std::string{text(done.error())},
                         status_of(done.error()));
}

} // namespace busbar::product
