#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/core/expected.hpp>

namespace busbar::generator {

/// The options of the command line.
struct Options {
    /// NodeSet2 files to generate from.
    std::vector<std::string> inputs;
    /// Dependencies: NodeSet2 files, most basic first, whose code exists already.
    struct Dependency {
        std::string path;
        /// The C++ namespace and the include path that they were generated with.
        std::string cpp_namespace;
        std::string include_path;
    };
    std::vector<Dependency> dependencies;
    std::string output_folder;
    /// The namespace to generate; that of the first model of the first input by default.
    std::string namespace_uri;
    std::string cpp_namespace{"busbar"};
    /// How generated headers name each other: "busbar/types" for <busbar/types/types.hpp>.
    std::string include_path{"busbar/types"};
    /// A CSV of "TypeName,file_name" rows that splits the structures over files.
    std::string groups_file;
    /// A CSV of "Name,identifier,NodeClass" rows with the names of the id constants; they are made
    /// of BrowseNames when there is none.
    std::string ids_file;
    /// Emit nodes.hpp and nodes.cpp, constant data, and not the types.
    bool nodes{false};
    /// Emit definitions.hpp and definitions.cpp, the DataTypes of namespace 0 as constant data.
    bool definitions{false};
    /// With `nodes`: a file with one NodeId a line ('#' starts a comment); only those are emitted.
    std::string node_list;
    /// With `nodes`: a CSV of rows "feature,number". Of the nodes below these only those of
    /// `features` are emitted.
    std::string features_file;
    std::vector<std::string> features;
    /// The nodes of `features` alone; all others are external.
    bool is_addition{false};
    /// Features that are there before an addition, in which its nodes lie.
    std::vector<std::string> given;
};

/// A message for a person: what failed, with the path.
using Failure = std::string;

/// Writes `text` to the file `name` in the output folder, which it creates.
[[nodiscard]] Expected<void, Failure> write_output(const Options& options, const std::string& name,
                                                   const std::string& text);

/// What the program prints if `word` is all that it is given: the text of --help and --version and,
/// for packaging, of --print-man. Nothing for any other word.
[[nodiscard]] std::optional<std::string> answer(std::string_view word);

/// The options of a command line, or the usage text with what is wrong.
[[nodiscard]] Expected<Options, Failure> parse_options(int argc, char** argv);

} // namespace busbar::generator
