#include <algorithm>
#include <set>

#include <busbar/core/text.hpp>

#include "controller/life/checksum.hpp"
#include "project_fields.hpp"
#include "project_lines.hpp"

namespace busbar::controller {

namespace {

using detail::ProjectLine;
using detail::ProjectLines;
using detail::ProjectSection;

/// Takes the values of a section from its lines and keeps the first problem.
class SectionReader {
public:
    SectionReader(ProjectSection& section, const ProjectLines& lines)
        : section_{section}, lines_{lines}
    {
    }

    void text(std::string_view name, std::string& to)
    {
        take(name, [&](std::string_view value) {
            to = value;
            return std::string{};
        });
    }
    void flag(std::string_view name, bool& to) { value(name, to); }
    void number(std::string_view name, std::uint32_t& to) { value(name, to); }
    void list(std::string_view name, std::vector<std::string>& to) { value(name, to); }
    template <typename T, std::size_t count>
    void choice(std::string_view name, T& to, const detail::Choices<T, count>& choices)
    {
        take(name, [&](std::string_view value) { return detail::read_value(value, to, choices); });
    }

    /// Returns the first problem, including a line that is not a value of the section.
    [[nodiscard]] Configured<void> end();

private:
    template <typename T>
    void value(std::string_view name, T& to)
    {
        take(name, [&](std::string_view value) { return detail::read_value(value, to); });
    }
    /// `read` returns what was expected, or nothing on success.
    template <typename Read>
    void take(std::string_view name, Read read)
    {
        const auto line = std::find_if(
            section_.lines.begin(), section_.lines.end(),
            [&](const ProjectLine& each) { return each.name == name && !each.is_used; });
        if (line == section_.lines.end()) {
            return fail(section_.number, name, "nothing", "a value");
        }
        line->is_used = true;
        if (const std::string expected = read(line->value); !expected.empty()) {
            fail(line->number, name, "\"" + printable(line->value, 64) + "\"", expected);
        }
    }
    void fail(std::size_t line, std::string_view name, std::string found, std::string_view expected)
    {
        if (!problem_) {
            problem_ = lines_.wrong(line, section_.title, name, std::move(found), expected).error();
        }
    }

    ProjectSection& section_;
    const ProjectLines& lines_;
    std::optional<Problem> problem_;
};

Configured<void> SectionReader::end()
{
    for (const ProjectLine& line : section_.lines) {
        if (!line.is_used) {
            fail(line.number, line.name, "it", "only values that the section has, each once");
        }
    }
    return problem_ ? Configured<void>{Unexpected{*problem_}} : Configured<void>{};
}

template <typename Visit, typename Of>
Configured<void> read_values(ProjectSection& section, const ProjectLines& lines, Of& to,
                             Visit visit)
{
    SectionReader reader{section, lines};
    visit(reader, to);
    return reader.end();
}

class ProjectReader {
public:
    ProjectReader(std::string_view document, const std::string& file, const ProjectLimits& limits)
        : lines_{document, file, limits}, limits_{limits}
    {
        project_.network.listeners.clear();
    }

    [[nodiscard]] Configured<Project> read();

private:
    [[nodiscard]] Configured<void> read_section(ProjectSection& section);
    [[nodiscard]] Configured<void> read_single(ProjectSection& section);
    [[nodiscard]] Configured<void> read_model(ProjectSection& section);
    [[nodiscard]] Configured<void> read_end(ProjectSection& section);
    [[nodiscard]] Configured<void> check_room(const ProjectSection& section, std::size_t found,
                                              std::size_t most) const
    {
        return found < most ? Configured<void>{}
                            : lines_.wrong(section.number, section.title, {}, "one more",
                                           "at most " + std::to_string(most));
    }

    ProjectLines lines_;
    const ProjectLimits& limits_;
    Project project_;
    std::set<std::string_view> seen_; // sections that occur once
    bool has_ended_{false};
};

Configured<void> ProjectReader::read_single(ProjectSection& section)
{
    Configured<void> done =
        lines_.wrong(section.number, section.title, {}, "it", "a section that a project has");
    detail::for_each_section([&](std::string_view title, auto visit) {
        if (title != section.title) {
            return;
        }
        done = seen_.insert(title).second
                   ? read_values(section, lines_, project_, visit)
                   : lines_.wrong(section.number, section.title, {}, "it again", "it once");
    });
    return done;
}

Configured<void> ProjectReader::read_model(ProjectSection& section)
{
    if (auto room = check_room(section, project_.models.size(), limits_.max_models); !room) {
        return room;
    }
    ProjectModel model;
    std::uint32_t size = 0;
    std::string sum;
    auto values = read_values(section, lines_, model, [&](SectionReader& reader, ProjectModel& to) {
        reader.text("name", to.name);
        reader.number("size", size);
        reader.text("checksum", sum);
    });
    if (!values) {
        return values;
    }
    if (size > limits_.max_model_size) {
        return lines_.wrong(section.number, section.title, "size", std::to_string(size),
                            "at most " + std::to_string(limits_.max_model_size));
    }
    const auto bytes = lines_.take(size);
    if (!bytes) {
        return Unexpected{bytes.error()};
    }
    if (const std::string found = detail::checksum_text(*bytes); found != sum) {
        return lines_.wrong(section.number, section.title, "checksum", printable(sum, 32),
                            found + ": " + printable(model.name) + " was changed or is damaged");
    }
    model.text = *bytes;
    project_.models.push_back(std::move(model));
    return {};
}

Configured<void> ProjectReader::read_end(ProjectSection& section)
{
    const std::string found = detail::checksum_text(lines_.before_last_line());
    std::string sum;
    auto values = read_values(section, lines_, sum, [](SectionReader& reader, std::string& to) {
        reader.text("checksum", to);
    });
    if (values && sum != found) {
        return lines_.wrong(section.number + 1, section.title, "checksum", printable(sum, 32),
                            found + ": the file was changed or is damaged");
    }
    has_ended_ = true;
    return values;
}

Configured<void> ProjectReader::read_section(ProjectSection& section)
{
    if (section.title == "listener") {
        auto& listeners = project_.network.listeners;
        return check_room(section, listeners.size(), limits_.max_listeners).and_then([&] {
            return read_values(section, lines_, listeners.emplace_back(),
                               [](auto& reader, auto& to) { detail::visit_listener(reader, to); });
        });
    }
    if (section.title == "user") {
        return check_room(section, project_.users.size(), limits_.max_users).and_then([&] {
            return read_values(section, lines_, project_.users.emplace_back(),
                               [](auto& reader, auto& to) { detail::visit_user(reader, to); });
        });
    }
    if (section.title == "model") {
        return read_model(section);
    }
    return section.title == "end" ? read_end(section) : read_single(section);
}

Configured<Project> ProjectReader::read()
{
    if (auto title = lines_.read_title(); !title) {
        return Unexpected{std::move(title.error())};
    }
    auto section = lines_.read_section();
    auto done = section
                    ? read_values(*section, lines_, project_,
                                  [](auto& reader, auto& to) { detail::visit_project(reader, to); })
                    : Configured<void>{Unexpected{section.error()}};
    while (done && !lines_.is_at_end() && !has_ended_) {
        section = lines_.read_section();
        done = section ? read_section(*section) : Configured<void>{Unexpected{section.error()}};
    }
    if (!done) {
        return Unexpected{std::move(done.error())};
    }
    if (!has_ended_ || !lines_.is_at_end()) {
        return lines_.wrong(has_ended_ ? "more text after [end]" : "the end of the file",
                            has_ended_ ? "nothing" : "[end]: the file is cut");
    }
    if (seen_.size() != detail::section_count) {
        return lines_.wrong(std::to_string(seen_.size()) + " of the sections",
                            "[network], [security], [certificate], [discovery] and [sampling]");
    }
    return std::move(project_);
}

} // namespace

Configured<Project> read_project(std::string_view document, const std::string& file,
                                 const ProjectLimits& limits)
{
    return ProjectReader{document, file, limits}.read();
}

} // namespace busbar::controller
