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
class ProgramSieve;
} // namespace detail

/// Limits of a program from any origin; they do not limit what is published.
struct ProgramLimits {
    std::size_t max_types{65'536};
    std::size_t max_variables{1'000'000};
    /// Members of one structure, enumerators of one type.
    std::size_t max_members{10'000};
    /// Nested types.
    std::size_t max_depth{64};
    std::size_t max_dimensions{16};
    /// Bytes of one variable, both in the CPU and in a process image.
    std::uint64_t max_variable_size{64U << 20U};
    std::size_t max_name_length{512}; // like a BrowseName (Part 3, 8.3)
};

/// A declared type after names have been resolved.
struct ResolvedType {
    /// The kind of type after all aliases.
    enum class Kind : std::uint8_t { Elementary, Enumeration, Structure, Union };

    Kind kind{Kind::Elementary};
    /// Dint for an Enumeration; unused for a Structure or Union.
    ElementaryType elementary{ElementaryType::Int};
    /// Set for all except Elementary.
    const DerivedType* type{nullptr};
    /// The declaration's own, followed by those of the types that are arrays themselves.
    std::vector<Bounds> dimensions{};
    /// For a text as in TypeUse; 1 for Char and Wchar.
    std::uint32_t string_length{0};
    std::optional<Bounds> subrange{};
    /// The initial value of the first resolved type that has one; null if none has.
    const InitialValue* initial{nullptr};

    [[nodiscard]] bool is_array() const { return !dimensions.empty(); }
    /// Returns the bytes of UTF-8 that a text has at most: three for a unit of UTF-16.
    [[nodiscard]] std::uint32_t text_bytes() const;
    /// Returns 1 if it is not an array.
    [[nodiscard]] std::uint64_t elements() const;
};

/// The types of a Program, checked: names are unique, no type contains itself, everything is within
/// the limits. Any thread may read it.
class BUSBAR_API ProgramTypes {
public:
    /// `program` must outlive it and must not change. The problem's `where` is "types[3] (Point).X"
    /// or "variables[7] (Speed)", with the line and column if these are known.
    [[nodiscard]] static Configured<ProgramTypes> create(const Program& program,
                                                         const ProgramLimits& limits = {});

    [[nodiscard]] const Program& program() const { return *program_; }
    /// Returns null if there is no type with this name.
    [[nodiscard]] const DerivedType* find(std::string_view name) const;
    /// `use` must belong to the program.
    [[nodiscard]] ResolvedType resolve(const TypeUse& use) const;
    /// Returns its size in bytes in the memory of an NJ or NX CPU (W506, A-5-1): 2 for BOOL, arrays
    /// of which have 16 in a word; 4 for an enumeration, 8 for times and dates, a text's length
    /// plus one, of units of two bytes for WSTRING. Members are at multiples of their alignment, a
    /// structure's size is a multiple of the largest one, and a union is as large as its largest
    /// member.
    [[nodiscard]] std::uint64_t size_of(const TypeUse& use) const;
    /// Bytes that it takes in a process image at most, which keeps a byte for each BOOL, also of an
    /// array, and a text's length in four bytes before it. A union, which no image can have, counts
    /// as its largest member.
    [[nodiscard]] std::uint64_t image_size_of(const TypeUse& use) const;

private:
    friend class detail::ProgramChecker;
    friend class detail::ProgramSieve;
    explicit ProgramTypes(const Program& program) : program_{&program} {}

    enum class Memory : std::uint8_t { Cpu, Image };
    /// Size and alignment of a value.
    struct Layout {
        std::uint64_t size{0};
        std::uint64_t alignment{1};
    };
    struct Layouts {
        Layout in_cpu;
        Layout in_image;
    };

    [[nodiscard]] static Layout layout_of(ElementaryType type, std::uint32_t length, Memory memory);
    /// Returns the layouts of one value, based on those of the types in it.
    [[nodiscard]] Layouts layouts_of_type(const DerivedType& type) const;
    [[nodiscard]] Layout layout_of_members(const DerivedType& type, Memory memory) const;
    [[nodiscard]] Layout layout_of_one(const ResolvedType& type, Memory memory) const;
    [[nodiscard]] Layout layout_of(const TypeUse& use, Memory memory) const;

    const Program* program_;
    /// Keyed by the name in lower case.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// The layouts of one value of each type, so that types nested repeatedly cost nothing.
    std::vector<Layouts> layouts_;
};

/// Returns the bytes of one value in the CPU, except for String and Wstring.
[[nodiscard]] BUSBAR_API std::uint32_t size_of(ElementaryType type);
/// The DataTypes of elementary types.
enum class ElementaryTypes : std::uint8_t {
    /// DataTypes of OPC 30000, version 1.02, if it defines the type: BYTE, WORD, DWORD, LWORD,
    /// TIME (Int64), DATE, TIME_OF_DAY (UInt32), DATE_AND_TIME and STRING.
    Plcopen,
    /// Only those of OPC UA itself, as in W588, 6-2-2: TIME is Double,
    /// TIME_OF_DAY and the dates are DateTime, bit strings the unsigned integers.
    BuiltIn,
};

/// Returns the type that it is published as: TIME as a Double of milliseconds, dates and times of
/// day as DateTime, bit strings as unsigned integers (W588, 6-2-2); but with
/// Plcopen TIME as an Int64 of milliseconds, TIME_OF_DAY as a UInt32 of milliseconds since midnight
/// (OPC 30000, 9.2). Enumerations are Int32.
///
/// LTIME, LDATE, LTIME_OF_DAY and LDATE_AND_TIME are published as the types without L; but with
/// Plcopen LTIME as an Int64 of nanoseconds, LTIME_OF_DAY as a UInt64 of nanoseconds since
/// midnight. A DateTime has a resolution of 100 ns. CHAR, WCHAR and WSTRING are String.
[[nodiscard]] BUSBAR_API BuiltInType
built_in_type_of(ElementaryType type, ElementaryTypes choice = ElementaryTypes::BuiltIn);
/// Returns "INT", for example.
[[nodiscard]] BUSBAR_API std::string_view name(ElementaryType type);

/// Converts the letters A to Z to lower case: equal names have equal results.
[[nodiscard]] BUSBAR_API std::string fold_name(std::string_view name);

} // namespace busbar::controller
