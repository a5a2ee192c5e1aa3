#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <busbar/core/variant.hpp>

/// What a controller's program declares: data types and global variables, as IEC 61131-3 has them.
/// Plain values, made by a reader of declarations or by a vendor from a symbol table of its own;
/// ProgramTypes::create checks them.
namespace busbar::controller {

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
};

/// Both ends belong to it.
struct Bounds {
    std::int64_t lower{0};
    std::int64_t upper{0};

    friend bool operator==(const Bounds&, const Bounds&) = default;
};

/// What a variable, a member or an alias is declared as.
struct TypeUse {
    /// Counts where `type_name` is empty.
    ElementaryType elementary{ElementaryType::Int};
    /// A type of the program; upper and lower case are the same.
    std::string type_name{};
    /// None: no array. The outermost first; types that are arrays themselves come within these.
    std::vector<Bounds> dimensions{};
    /// Of String: the most bytes of UTF-8, without the zero behind them.
    std::uint32_t string_length{255};
    /// Of integers: what values are allowed.
    std::optional<Bounds> subrange{};
};

/// Where something is declared, for who reads a Problem of it. Lines and columns count from 1; 0 is
/// not known.
struct ProgramPlace {
    std::uint32_t line{0};
    std::uint32_t column{0};
};

/// What something is before the program sets it. All default: zero, the first enumerator, an empty
/// text.
struct InitialValue {
    /// Tells values apart that are the same in `value`.
    enum class Notation : std::uint8_t {
        Unknown, // whatever the type needs
        Number,
        Text,
        Enumerator,
        Duration,
        Date,
        TimeOfDay,
        DateAndTime,
    };

    /// The member that it is for, within a structure.
    std::string member{};
    /// How many elements in turn have it, within an array.
    std::uint32_t repeat{1};
    /// Of an elementary type or, as a String, the name of an enumerator. Numbers are Int64, UInt64
    /// or Double whatever the type, TRUE and FALSE also Boolean, times Double in milliseconds,
    /// dates DateTime, times of day DateTime on 1601-01-01; null where there are parts.
    Variant value{};
    /// Members of a structure or elements of an array: of one with several dimensions either all of
    /// them, the last index first, or a list of lists, in which each is for one index.
    std::vector<InitialValue> parts{};
    /// The enumeration that `value` is said to be of, as in `Mode#On`; empty: not said.
    std::string enumeration{};
    Notation notation{Notation::Unknown};
    ProgramPlace place{};

    [[nodiscard]] bool empty() const { return value.is_null() && parts.empty(); }
};

struct Member {
    std::string name;
    TypeUse type{};
    InitialValue initial{};
    ProgramPlace place{};
};

struct Enumerator {
    std::string name;
    std::int32_t value{0};
};

/// A type that the program declares.
struct DerivedType {
    enum class Kind : std::uint8_t {
        Alias, // another name for `alias`: an array, a subrange
        Enumeration,
        Structure,
        Union,
    };

    std::string name;
    Kind kind{Kind::Structure};
    TypeUse alias{};                       // of an Alias
    std::vector<Enumerator> enumerators{}; // of an Enumeration
    std::vector<Member> members{};         // of a Structure or Union
    /// Of variables that have none of their own.
    InitialValue initial{};
    std::string comment{};
    ProgramPlace place{};
};

/// Who sees a variable (seed 000, 3-3-1). All but Hidden are the same to OPC UA.
enum class NetworkPublish : std::uint8_t { Hidden, PublishOnly, Input, Output };

struct GlobalVariable {
    /// Any text for a vendor's own names; identifiers in declarations. Upper and lower case are the
    /// same.
    std::string name;
    TypeUse type{};
    InitialValue initial{};
    NetworkPublish publish{NetworkPublish::Hidden};
    bool is_constant{false};
    /// RETAIN: keeps its value over a restart.
    bool is_retained{false};
    /// AT: "%IX0.0"; empty: wherever.
    std::string address{};
    std::string comment{};
    ProgramPlace place{};
};

/// What runs the program, as far as clients see it.
struct ProgramTask {
    std::string name;
    std::uint32_t priority{0};
    /// As IEC 61131-3 writes it: "T#10ms".
    std::string interval{};
};

struct ProgramInstance {
    std::string name;
    std::string type_name;
    /// Of a ProgramTask; empty: none.
    std::string task{};
};

struct Program {
    std::vector<DerivedType> types{};
    std::vector<GlobalVariable> variables{};
    std::vector<ProgramTask> tasks{};
    std::vector<ProgramInstance> instances{};
};

} // namespace busbar::controller
