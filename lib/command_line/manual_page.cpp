#include "manual_page.hpp"

#include <algorithm>
#include <cstddef>

namespace busbar::command_line {

namespace {

/// Escapes a line so that the formatter prints it as it is: no request, no escape sequence, and "-"
/// as the character that a shell reads.
std::string escaped(const std::string& line)
{
    std::string text{line.starts_with('.') || line.starts_with('\'') ? "\\&" : ""};
    for (const char character : line) {
        if (character == '\\') {
            text += "\\e";
        } else if (character == '-') {
            text += "\\-";
        } else {
            text += character;
        }
    }
    return text;
}

/// Formats paragraphs, which end at empty lines; indented lines stay as they are.
std::string paragraphs(const std::string& text)
{
    std::string result;
    bool is_kept = false;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t end = std::min(text.find('\n', from), text.size());
        const std::string line = text.substr(from, end - from);
        from = end + 1;
        if (line.starts_with(' ') != is_kept) {
            is_kept = !is_kept;
            result += is_kept ? ".nf\n" : ".fi\n";
        }
        result += line.empty() ? std::string{".PP\n"} : escaped(line) + "\n";
    }
    return result + (is_kept ? ".fi\n" : "");
}

std::string in_quotes(const std::string& text)
{
    std::string result{'"'};
    for (const char character : escaped(text)) {
        result += character == '"' ? std::string{"\\(dq"} : std::string{character};
    }
    return result + '"';
}

} // namespace

std::string text_of(const ManualPage& page, const std::string& version)
{
    std::string text =
        ".TH " + in_quotes(page.program) + " 1 \"\" " + in_quotes("Busbar " + version) +
        " \"User Commands\"\n.SH NAME\n" + escaped(page.program) + " \\- " + escaped(page.summary) +
        "\n.SH SYNOPSIS\n.B " + escaped(page.program) + "\n" + escaped(page.arguments) + "\n";
    for (const ManualPage::Section& section : page.sections) {
        text += (section.is_part ? ".SS " : ".SH ") + in_quotes(section.title) + "\n" +
                paragraphs(section.text);
        for (const ManualPage::Entry& entry : section.entries) {
            text += ".TP\n.B " + in_quotes(entry.name) + "\n" + paragraphs(entry.text);
        }
    }
    return text;
}

} // namespace busbar::command_line
