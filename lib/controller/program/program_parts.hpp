#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include <busbar/controller/declaration_reader.hpp>
#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>

#include "constant_table.hpp"
#include "declaration_cursor.hpp"
#include "inherited_members.hpp"
#include "program_problem.hpp"

namespace busbar::controller::detail {

/// The state that the parts of a program share while all of them are read once.
struct ReadingPass {
    ConstantTable& constants;
    MemoryBudget& memory;
    const DeclarationLimits& limits;
    Unserved unserved{Unserved::Refuse};
    /// The program so far, to which each part adds its own.
    Program program{};
    /// The structures among its types that extend others.
    std::vector<Extension> extensions{};
    /// The names of namespaces that were entered, folded.
    std::unordered_set<std::string> namespaces{};
};

/// The text of a file in UTF-8, with its name and its places. Both texts must outlive it.
struct SourceText {
    SourceText(std::string_view source_text, std::string_view file_name, std::uint32_t index = 0)
        : text{source_text}, file{file_name}, places{source_text, index}
    {
    }

    std::string_view text;
    std::string_view file;
    TextPlaces places;
};

/// A file of a program, or a part of one, in any format.
struct ProgramPart {
    /// The name of the file.
    std::string_view file{};
    /// Reads the part and adds it to the pass, any number of times with the same result.
    std::function<Configured<void>(ReadingPass& pass)> read{};
};

/// The parts of one program.
struct ProgramParts {
    std::vector<ProgramPart> list{};
    /// The names of the files if there are several, as in Program::files.
    std::vector<std::string> files{};
    /// Files that cannot be read at all.
    std::vector<LeftOut> left_out{};
    /// Parsed documents that the parts refer to, and the bytes that these take.
    std::vector<std::shared_ptr<const void>> documents{};
    std::size_t memory{0};
};

/// Adds a file of declarations, or a part of one. The source must outlive the parts.
struct DeclarationPart {
    /// The file up to the end of the part.
    std::string_view text{};
    /// The offset at which the part begins.
    std::size_t begin{0};
    /// The name of the list that its variables are in; empty: none.
    std::string_view list{};
};
BUSBAR_API void add_declarations(const SourceText& source, const DeclarationPart& part,
                                 ProgramParts& to);

/// Reads all parts as one program, in which they see each other's names, in as many passes as these
/// need. With several files, problems and what is left out begin with the name of a file.
[[nodiscard]] BUSBAR_API Configured<Program>
read_parts(const ProgramParts& parts, const DeclarationLimits& limits, Unserved unserved);

/// Gives initial values the form that their types need: a number for the name of a value of an
/// enumeration where the type is a number (`n : INT := Color.Red`), and the name for a number where
/// the type is an enumeration that has one of this number. Leaves other values to the checks of
/// CheckedProgram, which the program has not passed yet.
BUSBAR_API void settle_enumerators(Program& program);

} // namespace busbar::controller::detail
