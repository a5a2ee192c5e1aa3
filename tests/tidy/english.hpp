#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rules.hpp"

namespace busbar::tidy {

/// A comment or a string literal of a source file.
struct Prose {
    std::size_t line = 0; ///< index of the line that it begins on
    std::string text;     ///< lines of a comment are joined with blanks
    bool is_doc = false;  ///< begins with three slashes
};

/// The comments of a file; lines that follow each other are one comment.
[[nodiscard]] std::vector<Prose> comments(const File& file);
/// The string literals of a file that have a blank: texts for people, mostly.
[[nodiscard]] std::vector<Prose> literals(const File& file);

/// Turns of phrase that a reader has to read twice: which one, and how often `prose` has it.
/// "fragment": a doc comment that begins with no subject and no verb ("Of the scan.", "What is
/// sent."). "behind": where "after" is meant. "nobody": persons for code ("whoever asks").
/// "is-no": "is no name" for "is not a name", and "anew".
[[nodiscard]] std::map<std::string, std::size_t> count_phrases(const Prose& prose);

/// The area that texts of this path are counted in: "include", "stack" for the layers that firmware
/// links, "controller" for those above it, "tests" and "examples"; empty for other paths, and for
/// tests/tidy.
[[nodiscard]] std::string_view prose_area(std::string_view path);

/// Counts by area and phrase, with the places. Literals count as "<area>-messages".
struct PhraseCounts {
    std::map<std::pair<std::string, std::string>, std::vector<std::string>> places;

    void add(const File& file);
};

/// Compares the counts with ceilings, lines of "area phrase number": a count above its ceiling, a
/// ceiling that is missing, or one that a count has fallen far below.
[[nodiscard]] Findings check_phrases(const PhraseCounts& counts,
                                     const std::vector<std::string>& ceilings);

} // namespace busbar::tidy
