#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/built_in_type.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

namespace detail {
class ProgramChecker;
} // namespace detail

/// What a program may have, whoever wrote it; none of it is a limit of what is published.
struct ProgramLimits {
    std::size_t max_types{65'536};
    std::size_t max_variables{1'000'000};
    /// Members of one structure, enumerators of one type.
    std::size_t max_members{10'000};
    /// Types within one another.
    std::size_t max_depth{64};
    std::size_t max_dimensions{16};
    /// Bytes of one variable.
    std::uint64_t max_variable_size{64U << 20U};
    std::size_t max_name_length{512}; // as of a BrowseName (Part 3, 8.3)
};

/// What a declaration comes down to when names are followed.
struct ResolvedType {
    enum class Kind : std::uint8_t { Elementary, Enumeration, Structure, Union };

    Kind kind{Kind::Elementary};
    /// Dint for an Enumeration; means nothing for a Structure or Union.
    ElementaryType elementary{ElementaryType::Int};
    /// Of all but Elementary.
    const DerivedType* type{nullptr};
    /// The declaration's own, then those of the types that are arrays themselves.
    std::vector<Bounds> dimensions{};
    std::uint32_t string_length{0}; // of String
    std::optional<Bounds> subrange{};
    /// Of the types that were followed, the first that has one; null if none has.
    const InitialValue* initial{nullptr};

    [[nodiscard]] bool is_array() const { return !dimensions.empty(); }
    /// 1 if it is no array.
    [[nodiscard]] std::uint64_t elements() const;
};

/// The types of a Program, checked: every name is there once, none contains itself, everything is
/// within the limits. Any thread may read it.
class BUSBAR_API ProgramTypes {
public:
    /// `program` must outlive it and stay as it is. The problem's `where` is "types[3] (Point).X"
    /// or "variables[7] (Speed)", with the line and column where these are known.
    [[nodiscard]] static Configured<ProgramTypes> create(const Program& program,
                                                         const ProgramLimits& limits = {});

    [[nodiscard]] const Program& program() const { return *program_; }
    /// Null if there is none of this name.
    [[nodiscard]] const DerivedType* find(std::string_view name) const;
    /// `use` must be of the program.
    [[nodiscard]] ResolvedType resolve(const TypeUse& use) const;
    /// Bytes that it takes in the memory of an NJ or NX CPU (W506, A-5-1): 2 for BOOL, an array of
    /// which has 16 in a word; 4 for an enumeration, 8 for times and dates, a text's length and one
    /// more. Members lie at multiples of their own alignment, a structure ends at one of its
    /// largest member's, and a union is as large as its largest member.
    [[nodiscard]] std::uint64_t size_of(const TypeUse& use) const;

private:
    friend class detail::ProgramChecker;
    explicit ProgramTypes(const Program& program) : program_{&program} {}

    /// What a value takes, and what its place is a multiple of.
    struct Layout {
        std::uint64_t size{0};
        std::uint64_t alignment{1};
    };

    /// Of one value, from those of the types in it.
    [[nodiscard]] Layout layout_of_type(const DerivedType& type) const;
    [[nodiscard]] Layout layout_of_one(const ResolvedType& type) const;
    [[nodiscard]] Layout layout_of(const TypeUse& use) const;

    const Program* program_;
    /// By the name in lower case.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// Of one value of each type, so that types that lie twice in one another cost nothing.
    std::vector<Layout> layouts_;
};

/// Bytes of one, but for String.
[[nodiscard]] BUSBAR_API std::uint32_t size_of(ElementaryType type);
/// Which DataTypes elementary types have.
enum class ElementaryTypes : std::uint8_t {
    /// Those of OPC 30000 in its version 1.02 for the types that have one there: BYTE, WORD, DWORD,
    /// LWORD, TIME (Int64), DATE, TIME_OF_DAY (UInt32), DATE_AND_TIME and STRING.
    Plcopen,
    /// Those of OPC UA itself alone, as seed 000, 6-2-2 has them: TIME is Double, TIME_OF_DAY and
    /// the dates are DateTime, bit strings the unsigned integers.
    BuiltIn,
};

/// As which it is published: TIME as a Double of milliseconds, dates and times of day as DateTime,
/// bit strings as unsigned integers (seed 000, 6-2-2); but with Plcopen TIME as an Int64 of
/// milliseconds, TIME_OF_DAY as an UInt32 of milliseconds since midnight (OPC 30000, 9.2).
/// Enumerations are Int32.
[[nodiscard]] BUSBAR_API BuiltInType
built_in_type_of(ElementaryType type, ElementaryTypes choice = ElementaryTypes::BuiltIn);
/// "INT".
[[nodiscard]] BUSBAR_API std::string_view name(ElementaryType type);

/// The letters A to Z small, all else as it is: names that are the same have the same.
[[nodiscard]] BUSBAR_API std::string fold_name(std::string_view name);

} // namespace busbar::controller
