#include "project_lines.hpp"

#include <algorithm>
#include <utility>

#include <busbar/core/text.hpp>

#include "project_fields.hpp"

namespace busbar::controller::detail {

namespace {

constexpr std::string_view project_title = "busbar project ";
/// Greater than the number of values in any section.
constexpr std::size_t max_lines_of_section = 64;

} // namespace

Unexpected<Problem> ProjectLines::wrong(std::size_t line, std::string_view section,
                                        std::string_view name, std::string found,
                                        std::string_view expected) const
{
    std::string where = file_ + ":" + std::to_string(line);
    if (!section.empty()) {
        where += ": [" + std::string{section} + "]";
    }
    if (!name.empty()) {
        where += (section.empty() ? ": " : " ") + printable(name, 64);
    }
    return misconfigured(std::move(where),
                         "found " + std::move(found) + ", expected " + std::string{expected});
}

std::optional<std::string_view> ProjectLines::take_line()
{
    ++number_;
    last_line_ = at_;
    const std::size_t end = document_.find('\n', at_);
    if (end == std::string_view::npos) {
        return std::nullopt;
    }
    const std::string_view line = document_.substr(at_, end - at_);
    at_ = end + 1;
    return line;
}

Configured<void> ProjectLines::read_title()
{
    if (document_.size() > limits_.max_file_size) {
        return misconfigured(file_, "found " + std::to_string(document_.size()) +
                                        " bytes, expected at most " +
                                        std::to_string(limits_.max_file_size));
    }
    const auto line = take_line();
    if (!line || !line->starts_with(project_title)) {
        return wrong("another file", "\"busbar project 1\"");
    }
    std::uint32_t version = 0;
    const std::string_view number = line->substr(project_title.size());
    if (!read_value(number, version).empty()) {
        return wrong("version \"" + printable(number, 32) + "\"", "a number");
    }
    if (version != project_version) {
        return wrong("version " + std::to_string(version),
                     "version " + std::to_string(project_version) +
                         (version > project_version ? "; the file is of a newer program" : ""));
    }
    return {};
}

Configured<ProjectLine> ProjectLines::line_of(std::string_view text, std::string_view section) const
{
    const std::size_t sign = text.find(" =");
    if (sign == std::string_view::npos) {
        return wrong(number_, section, {}, "\"" + printable(text, 64) + "\"", "\"name = value\"");
    }
    std::string_view value = text.substr(sign + 2);
    value.remove_prefix(value.starts_with(' ') ? 1 : 0);
    const std::string_view name = text.substr(0, sign);
    if (value.size() > limits_.max_text) {
        return wrong(number_, section, name, std::to_string(value.size()) + " bytes",
                     "at most " + std::to_string(limits_.max_text));
    }
    if (!is_project_text(value)) {
        return wrong(number_, section, name, "\"" + printable(value, 64) + "\"",
                     "UTF-8 without control characters");
    }
    return ProjectLine{name, value, number_};
}

Configured<ProjectSection> ProjectLines::read_section()
{
    ProjectSection section;
    section.number = number_;
    // Values after the title that precede the first section belong to a section without a title.
    bool is_first = std::exchange(has_begun_, true);
    while (!is_at_end()) {
        const std::size_t before = at_;
        const auto text = take_line();
        if (!text) {
            return wrong("a line without its end", "the end of the line");
        }
        if (text->empty()) {
            continue;
        }
        if (text->starts_with('[')) {
            if (!is_first) {
                at_ = before; // belongs to the next one
                --number_;
                break;
            }
            if (!text->ends_with(']')) {
                return wrong("\"" + printable(*text, 64) + "\"", "\"[section]\"");
            }
            section.title = text->substr(1, text->size() - 2);
            section.number = number_;
            is_first = false;
            continue;
        }
        auto line = is_first ? wrong("\"" + printable(*text, 64) + "\"", "\"[section]\"")
                             : line_of(*text, section.title);
        if (!line) {
            return Unexpected{std::move(line.error())};
        }
        if (section.lines.size() == max_lines_of_section) {
            return wrong("more values", "at most " + std::to_string(max_lines_of_section));
        }
        section.lines.push_back(*line);
        if (section.title == "model" && section.lines.size() == 3) {
            break; // the model's file follows
        }
    }
    return section;
}

Configured<std::string_view> ProjectLines::take(std::size_t size)
{
    if (size >= document_.size() - at_) {
        return wrong(std::to_string(document_.size() - at_) + " bytes",
                     std::to_string(size) + " and the end of the line: the file is cut");
    }
    const std::string_view bytes = document_.substr(at_, size);
    number_ += static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n')) + 1;
    at_ += size;
    if (document_[at_] != '\n') {
        return wrong("more bytes", "the end of the line after the model");
    }
    ++at_;
    return bytes;
}

} // namespace busbar::controller::detail
