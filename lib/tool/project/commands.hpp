#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <busbar/controller/mapping_check.hpp>
#include <busbar/controller/project.hpp>
#include <busbar/controller/project_compare.hpp>
#include <busbar/controller/project_models.hpp>

#include "tool/connection/context.hpp"

/// The subcommands of `busbar project`, one file for each subject.

namespace busbar::tool::project {

/// The arguments of the offline subcommands.
struct ProjectArguments {
    /// The project file, and whatever the subcommand names.
    std::vector<std::string> words;
    /// Asks nothing.
    bool is_sure{false};
    std::string preset;
    std::string permission;
    std::string new_password_file;
    /// 0: the hash is scrypt's.
    std::uint32_t pbkdf2_iterations{0};
    /// A table to read.
    std::string table;
    bool replaces{false};
    /// Repairs a NodeSet2 file instead of refusing it.
    bool is_lenient{false};
    /// Also what is not mapped.
    bool wants_all{false};
    /// Only what is not mapped.
    bool wants_unmapped{false};
    bool has_parts{false};
    std::string part;
    std::string label;
    /// A PLC's program, whose labels are looked up.
    std::string program;
    /// The name of its encoding; empty: recognized.
    std::string encoding;
    /// Options for an instance.
    std::vector<std::string> optional;
    bool has_all_optional{false};
    /// PATH=TYPE of members.
    std::vector<std::string> types;
    std::string uri;
};

/// Carries a subcommand out; throws Failure.
using Action = Exit (*)(Context&, const ProjectArguments&);

/// Adds a subcommand that works with a file. It takes at least `least` words and at most `most`;
/// `word_names` is for the help: "FILE NAME [VALUE]".
CLI::App* add_offline(CLI::App& project, Run& run, const char* name, const char* text,
                      std::size_t least, std::size_t most, const char* word_names, Action action,
                      const std::shared_ptr<ProjectArguments>& arguments);

Exit show_tree(Context& context, const ProjectArguments& arguments);
/// Lists the declarations of labels, and the DataTypes of nodes that can be mapped to them.
Exit list_label_types(Context& context, const ProjectArguments& arguments);
/// Prints all that a model says about one node, and which parts can be mapped to which labels
/// (SH-082679, 9.4). `text` is a NodeId or a path from the Root.
Exit show_node(Context& context, const controller::Project& project, const std::string& text);

void add_settings(CLI::App& project, Run& run);
void add_models(CLI::App& project, Run& run);
void add_mapping(CLI::App& project, Run& run);
void add_roles(CLI::App& project, Run& run);
void add_check(CLI::App& project, Run& run);
void add_instances(CLI::App& project, Run& run);
void add_compare(CLI::App& project, Run& run);
void add_online(CLI::App& project, Run& run);

/// The project in the file; throws Failure.
[[nodiscard]] controller::Project open_project(const std::string& path);
/// Writes the project as a whole or not at all, readable for its owner only: it contains hashes of
/// passwords. Throws Failure.
void save_project(const std::string& path, const controller::Project& project);
/// The same for any file.
void save_file(const std::string& path, const std::string& text);
/// Throws Failure unless the user lets the file be replaced, if it is there.
void make_room(Context& context, const std::string& path, bool is_sure);

/// The project's models; throws Failure.
[[nodiscard]] controller::ModelSet open_models(const controller::Project& project);
/// All that is wrong with the project's models and mapping, and how full it is.
[[nodiscard]] controller::MappingCheck check_project_models(const controller::Project& project);
/// Lists the differences between two projects, including their models.
[[nodiscard]] std::vector<controller::ProjectDifference>
differences_of(const controller::Project& first, const controller::Project& second);
/// Prints differences as a table, or as JSON with members named like the titles in lower case.
/// Returns Failed if there are any.
Exit print_differences(Context& context,
                       const std::vector<controller::ProjectDifference>& differences,
                       const char* first, const char* second);
/// On standard error, a line each.
void print_reports(Context& context, const controller::ModelReports& reports);

} // namespace busbar::tool::project
