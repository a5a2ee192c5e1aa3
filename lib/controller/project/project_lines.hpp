#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/project.hpp>

namespace busbar::controller::detail {

/// A line "name = value" of a project file.
struct ProjectLine {
    std::string_view name;
    std::string_view value;
    std::size_t number{0};
    bool is_used{false};
};

/// A section of the file; refers to the file's text.
struct ProjectSection {
    std::string_view title; // empty before the first section
    std::size_t number{0};  // of the title's line
    std::vector<ProjectLine> lines{};
    /// Offset of the end of the section.
    std::size_t end{0};
};

/// Splits a project file into sections, one after the other.
class ProjectLines {
public:
    ProjectLines(std::string_view document, const std::string& file, const ProjectLimits& limits)
        : document_{document}, file_{file}, limits_{limits}
    {
    }

    /// Reads the first line, "busbar project 1".
    [[nodiscard]] Configured<void> read_title();
    /// Reads a section, up to the next one; a [model] ends with its last value.
    [[nodiscard]] Configured<ProjectSection> read_section();
    [[nodiscard]] bool is_at_end() const { return at_ == document_.size(); }
    /// Takes `size` bytes and the end of the line after them.
    [[nodiscard]] Configured<std::string_view> take(std::size_t size);
    /// The text before the value of the last line read.
    [[nodiscard]] std::string_view before_last_line() const
    {
        return document_.substr(0, last_line_);
    }

    /// Makes a problem at "line4.busbar:12: [network] host_name".
    [[nodiscard]] Unexpected<Problem> wrong(std::size_t line, std::string_view section,
                                            std::string_view name, std::string found,
                                            std::string_view expected) const;
    [[nodiscard]] Unexpected<Problem> wrong(std::string found, std::string_view expected) const
    {
        return wrong(number_, {}, {}, std::move(found), expected);
    }

private:
    /// Takes the next line with its end; nothing if the end is missing.
    [[nodiscard]] std::optional<std::string_view> take_line();
    [[nodiscard]] Configured<ProjectLine> line_of(std::string_view text,
                                                  std::string_view section) const;

    std::string_view document_;
    const std::string& file_;
    const ProjectLimits& limits_;
    std::size_t at_{0};
    std::size_t last_line_{0};
    std::size_t number_{0}; // number of the last line read
    bool has_begun_{false};
};

} // namespace busbar::controller::detail
