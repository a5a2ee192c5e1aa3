#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <busbar/controller/checked_program.hpp>
#include <busbar/core/problem.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

/// A file with types and global variables: PLCopen XML by its name, else declarations of IEC
/// 61131-3.
template <typename Program>
struct ProgramFile {
    /// As the file has it, to tell whether it is another one.
    std::shared_ptr<const std::string> text;
    std::shared_ptr<const Program> program;
    /// How messages call it.
    std::string name;
};

/// Reads and checks a program whose file has this name; problems name the file, and line and column
/// where these are known. Any thread.
[[nodiscard]] Configured<std::shared_ptr<const controller::CheckedProgram>>
read_program(std::string_view text, const std::string& name);
/// Reads the file of labels that the key names, whose types SimulatedLabels checks: it has some of
/// its own. Throws ConfigError, with the file's name, line and column if it is about what is in
/// there.
[[nodiscard]] ProgramFile<controller::Program> read_labels_program(const TomlTable& table,
                                                                   const std::string& key);
/// The same of a machine, with its types checked; a ReceivedProgram counts instead of the file.
[[nodiscard]] ProgramFile<controller::CheckedProgram> read_machine_program(const TomlTable& table,
                                                                           const std::string& key);

/// Names the file in a problem of the program as a whole.
[[nodiscard]] Problem in_file(Problem problem, const std::string& file);

} // namespace busbar::product
