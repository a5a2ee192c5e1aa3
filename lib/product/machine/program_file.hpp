#pragma once

#include <memory>
#include <string>

#include <busbar/controller/program.hpp>
#include <busbar/core/problem.hpp>

#include "product/configuration/toml_reader.hpp"

namespace busbar::product {

/// A file with types and global variables: PLCopen XML by its name, else declarations of IEC
/// 61131-3.
struct ProgramFile {
    /// As the file has it, to tell whether it is another one.
    std::shared_ptr<const std::string> text;
    std::shared_ptr<const controller::Program> program;
};

/// Reads the file that the key names. Throws ConfigError, with the file's name, line and column if
/// it is about what is in there.
[[nodiscard]] ProgramFile read_program_file(const TomlTable& table, const std::string& key);

/// A problem of the program as a whole has no file yet.
[[nodiscard]] Problem in_file(Problem problem, const std::string& file);

} // namespace busbar::product
