#pragma once

#include <array>
#include <cstddef>
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
    /// The initial value of a type that was resolved.
    struct Initial {
        /// Belongs to the type; not null.
        const InitialValue* value{nullptr};
        /// The number of dimensions around that type.
        std::size_t level{0};
    };
    /// In the order in which types were resolved. What the first ones leave out, such as the rest
    /// of an array, begins as the next ones say (IEC 61131-3, 6.4.4.5).
    std::vector<Initial> initials{};

    [[nodiscard]] bool is_array() const { return !dimensions.empty(); }
    /// True for a Structure and a Union, and arrays of these.
    [[nodiscard]] bool is_structured() const { return kind >= Kind::Structure; }
    /// Returns the bytes of UTF-8 that a text has at most: three for a unit of UTF-16.
    [[nodiscard]] std::uint32_t text_bytes() const;
    /// Returns 1 if it is not an array.
    [[nodiscard]] std::uint64_t elements() const;
};

/// The DataTypes of elementary types.
enum class ElementaryTypes : std::uint8_t {
    /// DataTypes of OPC 30000, version 1.02, if it defines the type: BYTE, WORD, DWORD, LWORD,
    /// TIME (Int64), DATE, TIME_OF_DAY (UInt32), DATE_AND_TIME and STRING.
    Plcopen,
    /// Only those of OPC UA itself, as in W588, 6-2-2: TIME is Double,
    /// TIME_OF_DAY and the dates are DateTime, bit strings the unsigned integers.
    BuiltIn,
};

/// A memory that values are in, which determines their sizes.
enum class ValueMemory : std::uint8_t {
    /// The memory of an NJ or NX CPU (W506, A-5-1): BOOL takes 2 bytes, arrays of it have 16 in a
    /// word; an enumeration takes 4, times and dates 8, a text its length plus one, for WSTRING in
    /// units of two bytes.
    Cpu,
    /// A process image: each BOOL takes a byte, also in an array; a text has its length in four
    /// bytes before its bytes of UTF-8. A union, which no image can have, counts as its largest
    /// member.
    Image,
    /// The memory that SIZEOF in a program refers to: BOOL takes 1 byte, an enumeration 2, TIME and
    /// dates without L take 4, others as many as in Cpu.
    Source,
};

/// The layout of a value in all its parts. Numbers are at most 2^56.
struct ValueLayout {
    /// The bytes of a value in a memory.
    struct Extent {
        /// Bytes with those between members.
        std::uint64_t size{0};
        /// The value starts at a multiple of this.
        std::uint64_t alignment{1};
    };

    /// In the order of ValueMemory. Members are at multiples of their alignment, a structure's size
    /// is a multiple of the largest one, and a union is as large as its largest member.
    std::array<Extent, 3> extents{};
    /// Values that are not structures; a union has as many as the member that has most.
    std::uint64_t values{1};
    /// The depth of nested structures and unions, this one included.
    std::uint64_t levels{0};
    /// It is or contains an array of several dimensions.
    bool has_matrix{false};
    /// It is or contains a union.
    bool has_union{false};
    /// It is or contains an array whose first index is not 0.
    bool has_first_index{false};

    /// Returns its bytes in that memory.
    [[nodiscard]] const Extent& in(ValueMemory memory) const
    {
        return extents[static_cast<std::size_t>(memory)];
    }
};

/// Lays out a value, which may be an array; `one` is the layout of its structure or union, if it is
/// of one.
[[nodiscard]] BUSBAR_API ValueLayout layout_of(const ResolvedType& type,
                                               const ValueLayout& one = {});

/// The types of a Program, checked: names are unique, no type contains itself, everything is within
/// the limits. Each type is laid out once. Any thread may read it.
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
    /// Returns the members of a structure or union, in their order.
    [[nodiscard]] const std::vector<ResolvedType>& members(const DerivedType& type) const
    {
        return parts_of(type).members;
    }
    /// Returns the layout of one value of a structure or union.
    [[nodiscard]] const ValueLayout& layout(const DerivedType& type) const
    {
        return parts_of(type).layout;
    }
    /// Returns the layout of a value, which may be an array.
    [[nodiscard]] ValueLayout layout(const ResolvedType& type) const
    {
        return layout_of(type, type.is_structured() ? layout(*type.type) : ValueLayout{});
    }
    /// Returns its size in bytes.
    [[nodiscard]] std::uint64_t size_of(const TypeUse& use,
                                        ValueMemory memory = ValueMemory::Cpu) const
    {
        return layout(resolve(use)).in(memory).size;
    }
    /// Returns a fingerprint: equal for types whose values have the same layout in an image of that
    /// choice and the same meaning, and otherwise different, with a chance of 1 to 2^64 for a
    /// mistake. Names of members and enumerators matter, names of types do not.
    [[nodiscard]] std::uint64_t print_of(const ResolvedType& type, ElementaryTypes choice) const;
    [[nodiscard]] std::uint64_t print_of(const TypeUse& use,
                                         ElementaryTypes choice = ElementaryTypes::BuiltIn) const
    {
        return print_of(resolve(use), choice);
    }

private:
    friend class detail::ProgramChecker;
    friend class detail::ProgramSieve;
    explicit ProgramTypes(const Program& program) : program_{&program} { index(); }

    struct Parts {
        std::vector<ResolvedType> members{};
        ValueLayout layout{};
        /// The fingerprints of one value, in the order of ElementaryTypes.
        std::array<std::uint64_t, 2> prints{};
    };

    /// Finds the types by their names.
    void index();
    /// Lays out one value, based on the layouts of the types in it.
    [[nodiscard]] Parts lay_out(const DerivedType& type) const;
    [[nodiscard]] const Parts& parts_of(const DerivedType& type) const
    {
        return parts_[static_cast<std::size_t>(&type - program_->types.data())];
    }

    const Program* program_;
    /// Keyed by the name in lower case.
    std::unordered_map<std::string, std::size_t> by_name_;
    /// In the order of the types.
    std::vector<Parts> parts_;
};

/// Returns the bytes of one value in the CPU, except for String and Wstring.
[[nodiscard]] BUSBAR_API std::uint32_t size_of(ElementaryType type);

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
