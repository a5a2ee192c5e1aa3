#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace busbar::tidy {

/// One source file: its path from the project's root, with '/', and its lines.
struct File {
    std::string path;
    std::vector<std::string> lines;
};

/// "lib/core/x.cpp:12: what is wrong".
using Findings = std::vector<std::string>;

[[nodiscard]] File make_file(std::string path, std::string_view text);

/// An include of a layer that stands below the file's own, or is not among what it may use.
void check_includes(const File& file, Findings& findings);
/// In lib/server an include of a floor above the file's own, or beside it.
void check_floors(const File& file, Findings& findings);
/// Files past 700 lines, functions past 70, lines past 100 columns.
void check_lengths(const File& file, Findings& findings);
/// Calls that the layer must not make.
void check_calls(const File& file, Findings& findings);
/// Variables of a thread or of the process: two servers in one process share nothing.
void check_state(const File& file, Findings& findings);
/// Absolute paths of somebody's machine, and headers that can be included twice.
void check_traces(const File& file, Findings& findings);
/// In a public header a virtual function that is defined elsewhere: the class's typeinfo is then
/// with that definition, in a library that may have none, and nobody with RTTI can derive from it.
void check_virtuals(const File& file, Findings& findings);

/// The types that a header of the library defines, forward declarations and nested ones left out.
[[nodiscard]] std::vector<std::string> defined_types(const File& file);
/// Types of that name that more than one of the headers defines, but for a few that may.
[[nodiscard]] Findings find_twins(const std::vector<File>& headers);

/// All rules that one file can break.
[[nodiscard]] Findings check(const File& file);

} // namespace busbar::tidy
