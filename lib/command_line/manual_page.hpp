#pragma once

#include <string>
#include <vector>

namespace busbar::command_line {

/// A manual page of a program, section 1.
struct ManualPage {
    /// What stands at the left, as "--config FILE", and what is said of it.
    struct Entry {
        std::string name;
        std::string text;
    };
    /// One heading: paragraphs of `text`, which an empty line separates, then the entries.
    struct Section {
        std::string title;
        std::string text;
        std::vector<Entry> entries;
        /// Whether it is a part of the section before it.
        bool is_part{false};
    };

    std::string program;
    /// One sentence, without the program's name.
    std::string summary;
    /// What stands after the program's name in the synopsis, as "[OPTIONS] NODE...".
    std::string arguments;
    std::vector<Section> sections;
};

/// The page as man(1) reads it, in the macros of man(7). It has no date, so that the same program
/// always has the same page.
[[nodiscard]] std::string text_of(const ManualPage& page, const std::string& version);

} // namespace busbar::command_line
