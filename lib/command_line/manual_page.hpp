#pragma once

#include <string>
#include <vector>

namespace busbar::command_line {

/// A manual page of a program, section 1.
struct ManualPage {
    /// An entry of a list: a name such as "--config FILE" and its description.
    struct Entry {
        std::string name;
        std::string text;
    };
    /// A section: a title, the paragraphs of `text`, separated by empty lines, and then the
    /// entries.
    struct Section {
        std::string title;
        std::string text;
        std::vector<Entry> entries;
        /// True for a part of the preceding section.
        bool is_part{false};
    };

    std::string program;
    /// One sentence, without the program's name.
    std::string summary;
    /// The arguments in the synopsis after the program's name, for example "[OPTIONS] NODE...".
    std::string arguments;
    std::vector<Section> sections;
};

/// Writes the page for man(1), with the macros of man(7). It has no date, so that the same program
/// always has the same page.
[[nodiscard]] std::string text_of(const ManualPage& page, const std::string& version);

} // namespace busbar::command_line
