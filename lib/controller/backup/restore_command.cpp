#include <busbar/controller/backup.hpp>

#include <algorithm>
#include <string>

#include <busbar/core/text.hpp>

namespace busbar::controller {

namespace {

constexpr std::size_t max_command_size = 65'536;

std::string_view trimmed(std::string_view text)
{
    constexpr std::string_view blanks = " \t\r";
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) {
        return {};
    }
    return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

bool is_same_word(std::string_view left, std::string_view right)
{
    const auto small = [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    };
    return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                      [&](char a, char b) { return small(a) == small(b); });
}

/// Parses one line of the section.
Configured<void> take_line(std::string_view line, const std::string& where, RestoreChoice& choice,
                           bool& is_chosen)
{
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) {
        return misconfigured(where, "found " + printable(line) + ", expected a name and =");
    }
    const std::string_view key = trimmed(line.substr(0, equals));
    const std::string_view value = trimmed(line.substr(equals + 1));
    const bool is_program = is_same_word(key, "UserProgram");
    if (!is_program && !is_same_word(key, "OpcuaSPF")) {
        return {};
    }
    const bool is_yes = is_same_word(value, "yes");
    if (!is_yes && (is_program || !is_same_word(value, "no"))) {
        return misconfigured(where, std::string{key} + ": found " + printable(value) +
                                        (is_program ? ", expected yes" : ", expected yes or no"));
    }
    if (!is_program) {
        if (is_chosen) {
            return misconfigured(where, "found OpcuaSPF twice, expected it once");
        }
        is_chosen = true;
        choice.security_profile = is_yes;
    }
    return {};
}

} // namespace

Configured<RestoreChoice> read_restore_command(std::string_view text)
{
    constexpr std::string_view file = "RestoreCommand.ini";
    if (text.size() > max_command_size) {
        return misconfigured(std::string{file}, "is too large", status::Bad_OutOfRange);
    }
    RestoreChoice choice;
    bool is_in_section = false;
    bool has_section = false;
    bool is_chosen = false;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.empty() || line.front() == ';') {
            continue;
        }
        if (line.front() == '[') {
            is_in_section = is_same_word(line, "[Restore]");
            has_section = has_section || is_in_section;
            continue;
        }
        if (!is_in_section) {
            continue;
        }
        const std::string where = std::string{file} + ":" + std::to_string(number);
        if (auto taken = take_line(line, where, choice, is_chosen); !taken) {
            return Unexpected{std::move(taken.error())};
        }
    }
    if (!has_section) {
        return misconfigured(std::string{file}, "found no section [Restore]");
    }
    return choice;
}

} // namespace busbar::controller
