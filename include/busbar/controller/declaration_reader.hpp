#pragma once

#include <cstddef>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// What a text of declarations may have, whoever wrote it. Reading takes time in proportion to the
/// text, and no more memory than is said here.
struct DeclarationLimits {
    std::size_t max_text_size{64U << 20U};
    /// Bytes that the Program may take; a list of names with one initial value has a copy for each.
    std::size_t max_memory{512U << 20U};
    /// Aggregates and lists within one another.
    std::size_t max_depth{32};
    std::size_t max_dimensions{16};
    /// Bytes of a name.
    std::size_t max_name_length{512}; // as of a BrowseName (Part 3, 8.3)
};

/// Types and global variables from declarations as IEC 61131-3, 3rd edition, writes them.
///
/// `text` is UTF-8, with or without a byte order mark. It has, in any number and order, whether in
/// upper or lower case:
///
/// - `TYPE ... END_TYPE`: STRUCT, UNION, enumerations (`(A := 1, B)`, `(A, B) INT`, `INT (A, B)`),
///   subranges (`INT (0..100)`), arrays of any bounds and dimensions, other names for types,
///   STRING[n] and STRING(n), each with an initial value. Types may be used before they are
///   declared. Behind END_STRUCT and END_UNION the `;` may be missing.
/// - `VAR_GLOBAL [CONSTANT] [RETAIN | NON_RETAIN] ... END_VAR`, with AT, initial values and several
///   names in one declaration. PERSISTENT, as some vendors call it, is RETAIN.
/// - `CONFIGURATION`, `RESOURCE`, `TASK` and `PROGRAM ... WITH task : type`, for tasks and
/// instances.
///
/// Comments are `(* *)`, `/* */`, both within one another, and `//`. The first one that begins
/// behind a declaration, in its last line, is the declaration's own.
///
/// `{attribute 'publish' := 'output'}` is what a variable's Network Publish attribute is written as
/// (seed 000, 3-3-1): 'none', 'publish only', 'input' or 'output'. It stands before a declaration,
/// before its `;`, or before VAR_GLOBAL, then for all in that block that have none of their own.
/// Also read are: without the word attribute; without quotes or with double ones; 'do not publish'
/// and 'hidden' for none, 'public only' and 'public' for publish only, with blanks, hyphens,
/// underscores or nothing between the words; `{attribute 'OPC.UA.DA' := '1'}` as publish only and
/// '0' as none. All other pragmas mean nothing.
///
/// The `$` of texts gives bytes of UTF-8 in '...' and UTF-16 in "...". Not read are expressions and
/// names of constants, types that have no name of their own but arrays and subranges, and types of
/// characters and of 64 bit times (LTIME, CHAR, WSTRING and others).
///
/// `file_name` is for problems, whose `where` is "machine.st:12:5", columns counted in characters;
/// there is no more than the first one. What names and values mean is not looked at:
/// ProgramTypes::create and check_initial_values do.
[[nodiscard]] BUSBAR_API Configured<Program>
read_declarations(std::string_view text, std::string_view file_name,
                  const DeclarationLimits& limits = {});

} // namespace busbar::controller
