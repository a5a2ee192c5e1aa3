#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <busbar/controller/checked_program.hpp>
#include <busbar/core/log.hpp>
#include <busbar/core/problem.hpp>

#include "product/configuration/toml_reader.hpp"
#include "product/store/source_files.hpp"

namespace busbar::product {

/// A file with types and global variables, of a format that read_program_text() recognizes.
template <typename Program>
struct ProgramFile {
    /// The file's text, for comparing.
    std::shared_ptr<const std::string> text;
    std::shared_ptr<const Program> program;
    /// The file's name in messages. For a machine it is the path as configured, which may be that
    /// of several files (see paths_in_line), or the name of the ReceivedProgram.
    std::string name;
};

/// Reads and checks a program from a file of this name; problems have the file, and line and column
/// if known. Thread-safe.
[[nodiscard]] Configured<std::shared_ptr<const controller::CheckedProgram>>
read_program(std::string_view text, const std::string& name, const ProgramReading& reading);
/// Reads a program of labels like that; its types are not checked.
[[nodiscard]] Configured<std::shared_ptr<const controller::Program>>
read_labels(std::string_view text, const std::string& name, const ProgramReading& reading);
/// Reads the keys "strict" and "encoding" of a section with a program.
[[nodiscard]] ProgramReading read_reading(const TomlTable& table);
/// Reads the file of labels that the key names, with what read_reading() says; SimulatedLabels
/// checks its types, because it adds some of its own. Throws ConfigError, with name, line and
/// column for a problem in the file.
[[nodiscard]] ProgramFile<controller::Program> read_labels_program(const TomlTable& table,
                                                                   const std::string& key);
/// The same for a machine, with its types checked; a ReceivedProgram replaces the file.
[[nodiscard]] ProgramFile<controller::CheckedProgram> read_machine_program(const TomlTable& table,
                                                                           const std::string& key);

/// Reads the path of a program as SourceFiles::program_text() takes it: a text, or a list of texts.
[[nodiscard]] std::string read_program_path(const TomlTable& table, const std::string& key);
/// Returns the paths of the files and folders in such a path; none if it is empty.
[[nodiscard]] std::vector<std::string> paths_of(const std::string& program_file);
/// Writes such a path in one line, for messages.
[[nodiscard]] std::string paths_in_line(std::string path);
/// Returns the name of a program at such a path: without folders, as is_program_name() allows.
[[nodiscard]] std::string program_name_of(const std::string& path);

/// Adds the file's name to a problem of the whole program, unless it has the name of one of the
/// program's files already.
[[nodiscard]] Problem in_file(Problem problem, const std::string& file,
                              const controller::Program& program);
/// The same for something that is left out.
[[nodiscard]] Problem in_file(const controller::LeftOut& one, const std::string& file);
/// Lists what is left out of a program, each with file, place and reason; without units, which are
/// no variables.
[[nodiscard]] std::vector<std::string> left_out_texts(const controller::Program& program,
                                                      const std::string& file);
/// Tells the log what is left out of a program, except for variables that were to be published, and
/// its encoding if that is not UTF-8.
void tell_left_out(LogSink& log, const controller::Program& program, const std::string& file);
/// Tells the log what left_out_texts() lists of the file.
void tell_left_out(LogSink& log, std::span<const std::string> texts, const std::string& file);

} // namespace busbar::product
