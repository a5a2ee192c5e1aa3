#pragma once

#include <cstddef>
#include <string_view>

#include <busbar/controller/program.hpp>
#include <busbar/controller/text_encoding.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// Limits for a text of declarations from any origin. Reading takes time in proportion to the text,
/// and no more memory than these allow.
struct DeclarationLimits {
    std::size_t max_text_size{64U << 20U};
    /// Maximum size of the Program in bytes; a list of names with one initial value stores a copy
    /// for each.
    std::size_t max_memory{512U << 20U};
    /// Maximum depth of nested aggregates and lists.
    std::size_t max_depth{32};
    std::size_t max_dimensions{16};
    /// In bytes.
    std::size_t max_name_length{512}; // like a BrowseName (Part 3, 8.3)
};

/// Reads types and global variables from declarations as in IEC 61131-3, 3rd edition.
///
/// `text` is in this encoding, see decode_text. It has, in any number and order, in upper or lower
/// case:
///
/// - `TYPE ... END_TYPE`: STRUCT, UNION, enumerations (`(A := 1, B)`, `(A, B) INT`, `INT (A, B)`),
///   subranges (`INT (0..100)`), arrays of any bounds and dimensions, other names for types,
///   STRING[n] and STRING(n), each with an initial value. Types may be used before they are
///   declared. The `;` after END_STRUCT and END_UNION is optional. `TYPE B EXTENDS A : STRUCT` has
///   the members of A before its own.
/// - `VAR_GLOBAL [CONSTANT] [RETAIN | NON_RETAIN] ... END_VAR`, with AT, initial values and several
///   names in one declaration. PERSISTENT, as some vendors call it, is RETAIN.
/// - `CONFIGURATION`, `RESOURCE`, `TASK` and `PROGRAM ... WITH task : type`, for tasks and
///   instances.
///
/// Comments are `(* *)`, `/* */`, both nested within each other, and `//`. The first one that
/// begins after a declaration, on its last line, belongs to that declaration.
///
/// `{attribute 'publish' := 'output'}` sets a variable's Network Publish attribute (manual of
/// variables mode, 3-3-1): 'none', 'publish only', 'input' or 'output'. It precedes a declaration,
/// its `;`, or VAR_GLOBAL, where it applies to all variables of that block without an attribute of
/// their own. Also accepted are: without the word attribute; without quotes or with double ones;
/// 'do not publish' and 'hidden' for none, 'public only' and 'public' for publish only, with
/// blanks, hyphens, underscores or nothing between the words; `{attribute 'OPC.UA.DA' := '1'}` as
/// publish only and '0' as none. All other pragmas are ignored.
///
/// Where a type is expected there may also be a structure, a union or an enumeration without a
/// name. It becomes a type that is named after the declaration that it is in, such as
/// "Press.Position.STRUCT", "Press.UNION" or "Mode.ENUM".
///
/// The `$` of texts stands for bytes of UTF-8 in '...' and UTF-16 in "...". BIT is BOOL.
///
/// Bounds, lengths, values of enumerations, initial values and repetitions are expressions with
/// constants (`VAR_GLOBAL CONSTANT`) and values of enumerations, before or after their declaration,
/// also as `Gvl.N`, `Color.Red` and `Color#Red`; with the operators of IEC 61131-3, shifts,
/// conversions such as INT_TO_REAL, some functions such as MAX, and SIZEOF of a type. A number that
/// does not fit 64 bits, a division by zero and constants that depend on each other are problems.
///
/// With Unserved::LeaveOut the text may be a whole program: program organization units, INTERFACE,
/// VAR_CONFIG, VAR_ACCESS and USING are skipped, NAMESPACE is read as if its declarations stood
/// outside. A declaration that is not understood goes to Program::left_out, and reading continues
/// after it. The program is refused only if it is too large, or if nothing is understood.
///
/// `file_name` is for problems, whose `where` is "machine.st:12:5", with columns counted in
/// characters; only the first problem is reported. The meaning of names and values is not checked:
/// CheckedProgram does that.
[[nodiscard]] BUSBAR_API Configured<Program>
read_declarations(std::string_view text, std::string_view file_name,
                  const DeclarationLimits& limits = {}, Unserved unserved = Unserved::Refuse,
                  TextEncoding encoding = TextEncoding::Recognized);

} // namespace busbar::controller
