#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <busbar/core/problem.hpp>
#include <busbar/core/variant.hpp>

/// The declarations of a controller's program: data types and global variables as in IEC 61131-3.
/// Plain values, created by a reader of declarations or by a vendor from its symbol table;
/// ProgramTypes::create checks them.
namespace busbar::controller {

enum class TextEncoding : std::uint8_t; // text_encoding.hpp

/// The elementary types of IEC 61131-3.
enum class ElementaryType : std::uint8_t {
    Bool,
    Sint,
    Int,
    Dint,
    Lint,
    Usint,
    Uint,
    Udint,
    Ulint,
    Byte,
    Word,
    Dword,
    Lword,
    Real,
    Lreal,
    Time,
    Date,
    TimeOfDay,
    DateAndTime,
    String,
    // Types of the 3rd edition.
    Ltime,
    Ldate,
    LtimeOfDay,
    LdateAndTime,
    Char,
    Wchar,
    Wstring,
};

/// True for String, Wstring, Char and Wchar, which are published as String.
[[nodiscard]] constexpr bool is_text(ElementaryType type)
{
    return type == ElementaryType::String || type >= ElementaryType::Char;
}
/// True for Wstring and Wchar, whose characters are units of UTF-16.
[[nodiscard]] constexpr bool is_wide(ElementaryType type)
{
    return type == ElementaryType::Wstring || type == ElementaryType::Wchar;
}

/// Both are included.
struct Bounds {
    std::int64_t lower{0};
    std::int64_t upper{0};

    friend bool operator==(const Bounds&, const Bounds&) = default;
};

/// The declared type of a variable, a member or an alias.
struct TypeUse {
    /// Used if `type_name` is empty.
    ElementaryType elementary{ElementaryType::Int};
    /// A type of the program; case is ignored.
    std::string type_name{};
    /// Empty if it is not an array. The outermost first; dimensions of types that are arrays
    /// themselves follow these.
    std::vector<Bounds> dimensions{};
    /// For String the maximum bytes of UTF-8, for Wstring the maximum units of UTF-16, both without
    /// the terminating zero.
    std::uint32_t string_length{255};
    /// For integers: the allowed values.
    std::optional<Bounds> subrange{};
};

/// The place of a declaration, for Problems. Lines and columns count from 1; 0 is unknown.
struct ProgramPlace {
    std::uint32_t line{0};
    std::uint32_t column{0};
    /// The index in Program::files plus one; 0 for the only file of a program.
    std::uint32_t file{0};
};

/// The value of something before the program sets it. All default: zero, the first enumerator, an
/// empty text.
struct InitialValue {
    /// Distinguishes notations that have the same `value`.
    enum class Notation : std::uint8_t {
        Unknown, // any that the type needs
        Number,
        Text,
        Enumerator,
        Duration,
        Date,
        TimeOfDay,
        DateAndTime,
    };

    /// Within a structure, the member that it initializes.
    std::string member{};
    /// Within an array, the number of consecutive elements with this value.
    std::uint32_t repeat{1};
    /// The value of an elementary type or, as a String, the name of an enumerator. Numbers are
    /// Int64, UInt64 or Double regardless of the type, TRUE and FALSE also Boolean, times Double in
    /// milliseconds, dates DateTime, times of day DateTime on 1601-01-01; null if there are parts.
    Variant value{};
    /// Members of a structure or elements of an array; with several dimensions either all elements,
    /// the last index varying fastest, or nested lists, with one list for each index.
    std::vector<InitialValue> parts{};
    /// The enumeration that qualifies `value`, as in `Mode#On`; empty: not qualified.
    std::string enumeration{};
    Notation notation{Notation::Unknown};
    ProgramPlace place{};

    [[nodiscard]] bool empty() const { return value.is_null() && parts.empty(); }
};

/// A member of a structure or a union.
struct Member {
    std::string name;
    TypeUse type{};
    InitialValue initial{};
    ProgramPlace place{};
};

/// A value of an enumeration.
struct Enumerator {
    std::string name;
    std::int32_t value{0};
};

/// A type that the program declares.
struct DerivedType {
    /// The kind of type that is declared.
    enum class Kind : std::uint8_t {
        Alias, // another name for `alias`: an array, a subrange
        Enumeration,
        Structure,
        Union,
    };

    std::string name;
    Kind kind{Kind::Structure};
    TypeUse alias{};                       // for an Alias
    std::vector<Enumerator> enumerators{}; // for an Enumeration
    std::vector<Member> members{};         // for a Structure or Union
    /// For variables without their own.
    InitialValue initial{};
    std::string comment{};
    ProgramPlace place{};
};

/// The visibility of a variable (W588, 3-3-1). All except Hidden are the same
/// for OPC UA.
enum class NetworkPublish : std::uint8_t { Hidden, PublishOnly, Input, Output };

/// A global variable as the program declares it.
struct GlobalVariable {
    /// Any text for a vendor's own names; identifiers in declarations. Case is ignored.
    std::string name;
    TypeUse type{};
    InitialValue initial{};
    NetworkPublish publish{NetworkPublish::Hidden};
    bool is_constant{false};
    /// RETAIN: keeps its value over a restart.
    bool is_retained{false};
    /// AT: "%IX0.0"; empty: any address.
    std::string address{};
    std::string comment{};
    ProgramPlace place{};
};

/// A task that runs program instances, as far as clients see it.
struct ProgramTask {
    std::string name;
    std::uint32_t priority{0};
    /// A literal of IEC 61131-3: "T#10ms".
    std::string interval{};
};

/// A program that a task runs.
struct ProgramInstance {
    std::string name;
    std::string type_name;
    /// The name of a ProgramTask; empty: none.
    std::string task{};
};

/// Says what a reader does with declarations that it cannot serve.
enum class Unserved : std::uint8_t {
    Refuse,   // the whole program
    LeaveOut, // only the declaration
};

/// A declaration that is not served.
struct LeftOut {
    /// The kinds of declarations that can be left out.
    enum class Kind : std::uint8_t {
        /// A passage without a name, or a whole file, which has its name.
        Part,
        Type,
        /// A function block, a program or another unit with statements; a type of variables that
        /// are not served.
        Unit,
        Variable,
    };

    /// Says what was declared.
    Kind kind{Kind::Part};
    /// The declaration as far as it was understood: a name, a place and whether to publish it.
    GlobalVariable declared{};
    /// The reason; `where` begins with the name of the file if the program has several, and with
    /// line and column if these are known.
    Problem problem{};
};

/// Everything that a program declares.
struct Program {
    std::vector<DerivedType> types{};
    std::vector<GlobalVariable> variables{};
    std::vector<ProgramTask> tasks{};
    std::vector<ProgramInstance> instances{};
    /// Declarations that the program has and that the lists above lack.
    std::vector<LeftOut> left_out{};
    /// The encoding of the text that it was read from, UTF-8 without a text. Of several files the
    /// first one that is not UTF-8.
    TextEncoding encoding{};
    /// The names of its files if it was read from several, as read_program_files() gives them.
    std::vector<std::string> files{};
};

} // namespace busbar::controller
