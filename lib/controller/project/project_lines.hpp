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

/// A section as it stands in the file; views into it.
struct ProjectSection {
    std::string_view title; // empty: what is before the first one
    std::size_t number{0};  // of its line
    std::vector<ProjectLine> lines{};
    /// Where the section ends.
    std::size_t end{0};
};

/// Takes a project file apart into sections, one after the other.
class ProjectLines {
public:
    ProjectLines(std::string_view document, const std::string& file, const ProjectLimits& limits)
        : document_{document}, file_{file}, limits_{limits}
    {
    }

    /// The first line, "busbar project 1".
    [[nodiscard]] Configured<void> read_title();
    /// The next section up to the next one; a [model] ends with its last value.
    [[nodiscard]] Configured<ProjectSection> read_section();
    [[nodiscard]] bool is_at_end() const { return at_ == document_.size(); }
    /// `size` bytes and the end of the line.
    [[nodiscard]] Configured<std::string_view> take(std::size_t size);
    /// What is before the value of the line that was read last.
    [[nodiscard]] std::string_view before_last_line() const
    {
        return document_.substr(0, last_line_);
    }

    /// "line4.busbar:12: [network] host_name".
    [[nodiscard]] Unexpected<Problem> wrong(std::size_t line, std::string_view section,
                                            std::string_view name, std::string found,
                                            std::string_view expected) const;
    [[nodiscard]] Unexpected<Problem> wrong(std::string found, std::string_view expected) const
    {
        return wrong(number_, {}, {}, std::move(found), expected);
    }

private:
    /// The next line; its end is taken, too. Nothing for one that has none.
    [[nodiscard]] std::optional<std::string_view> take_line();
    [[nodiscard]] Configured<ProjectLine> line_of(std::string_view text,
                                                  std::string_view section) const;

    std::string_view document_;
    const std::string& file_;
    const ProjectLimits& limits_;
    std::size_t at_{0};
    std::size_t last_line_{0};
    std::size_t number_{0}; // of the line that was read last
    bool has_begun_{false};
};

} // namespace busbar::controller::detail
