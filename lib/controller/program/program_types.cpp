#include <busbar/controller/program_types.hpp>

#include <algorithm>
#include <array>

#include "program_checker.hpp"

namespace busbar::controller {

namespace {

struct ElementaryRow {
    std::string_view name;
    std::uint32_t size;
    BuiltInType built_in;
};

/// Rows in the order of ElementaryType.
constexpr std::array elementary_rows{
    ElementaryRow{"BOOL", 2, BuiltInType::Boolean},
    ElementaryRow{"SINT", 1, BuiltInType::SByte},
    ElementaryRow{"INT", 2, BuiltInType::Int16},
    ElementaryRow{"DINT", 4, BuiltInType::Int32},
    ElementaryRow{"LINT", 8, BuiltInType::Int64},
    ElementaryRow{"USINT", 1, BuiltInType::Byte},
    ElementaryRow{"UINT", 2, BuiltInType::UInt16},
    ElementaryRow{"UDINT", 4, BuiltInType::UInt32},
    ElementaryRow{"ULINT", 8, BuiltInType::UInt64},
    ElementaryRow{"BYTE", 1, BuiltInType::Byte},
    ElementaryRow{"WORD", 2, BuiltInType::UInt16},
    ElementaryRow{"DWORD", 4, BuiltInType::UInt32},
    ElementaryRow{"LWORD", 8, BuiltInType::UInt64},
    ElementaryRow{"REAL", 4, BuiltInType::Float},
    ElementaryRow{"LREAL", 8, BuiltInType::Double},
    ElementaryRow{"TIME", 8, BuiltInType::Double},
    ElementaryRow{"DATE", 8, BuiltInType::DateTime},
    ElementaryRow{"TIME_OF_DAY", 8, BuiltInType::DateTime},
    ElementaryRow{"DATE_AND_TIME", 8, BuiltInType::DateTime},
    ElementaryRow{"STRING", 0, BuiltInType::String},
    ElementaryRow{"LTIME", 8, BuiltInType::Double},
    ElementaryRow{"LDATE", 8, BuiltInType::DateTime},
    ElementaryRow{"LTIME_OF_DAY", 8, BuiltInType::DateTime},
    ElementaryRow{"LDATE_AND_TIME", 8, BuiltInType::DateTime},
    ElementaryRow{"CHAR", 1, BuiltInType::String},
    ElementaryRow{"WCHAR", 2, BuiltInType::String},
    ElementaryRow{"WSTRING", 0, BuiltInType::String},
};
static_assert(elementary_rows.size() == static_cast<std::size_t>(ElementaryType::Wstring) + 1);

/// Caps sizes so that sums of unchecked types stay in range; the checker allows far less.
constexpr std::uint64_t max_size = std::uint64_t{1} << 56U;

std::uint64_t saturating_product(std::uint64_t a, std::uint64_t b)
{
    return b != 0 && a > max_size / b ? max_size : a * b;
}

constexpr std::uint64_t bits_of_word = 16;
/// Size of a text's length in a process image.
constexpr std::uint64_t size_of_length = 4;

std::uint64_t rounded_up(std::uint64_t size, std::uint64_t multiple)
{
    return (size + multiple - 1) / multiple * multiple;
}

std::uint32_t length_of(const TypeUse& use)
{
    if (use.elementary == ElementaryType::Char || use.elementary == ElementaryType::Wchar) {
        return 1;
    }
    return is_text(use.elementary) ? use.string_length : 0;
}

/// Bytes of a text in the CPU with the zero that ends it, which a single character does not have.
std::uint64_t text_size_in_cpu(ElementaryType type, std::uint32_t length)
{
    const std::uint64_t fixed = size_of(type);
    return fixed != 0 ? fixed : (std::uint64_t{length} + 1) * (is_wide(type) ? 2 : 1);
}

std::uint64_t text_bytes_of(ElementaryType type, std::uint32_t length)
{
    constexpr std::uint64_t bytes_of_unit = 3;
    return length * (is_wide(type) ? bytes_of_unit : 1);
}

ResolvedType::Kind kind_of(DerivedType::Kind kind)
{
    switch (kind) {
    case DerivedType::Kind::Enumeration:
        return ResolvedType::Kind::Enumeration;
    case DerivedType::Kind::Union:
        return ResolvedType::Kind::Union;
    default:
        return ResolvedType::Kind::Structure;
    }
}

} // namespace

std::uint64_t ResolvedType::elements() const
{
    std::uint64_t product = 1;
    for (const Bounds& bounds : dimensions) {
        product = saturating_product(product, static_cast<std::uint64_t>(bounds.upper) -
                                                  static_cast<std::uint64_t>(bounds.lower) + 1);
    }
    return product;
}

std::uint32_t ResolvedType::text_bytes() const
{
    return static_cast<std::uint32_t>(
        std::min(text_bytes_of(elementary, string_length), std::uint64_t{UINT32_MAX} - 1));
}

Configured<ProgramTypes> ProgramTypes::create(const Program& program, const ProgramLimits& limits)
{
    ProgramTypes types{program};
    for (std::size_t i = 0; i < program.types.size(); ++i) {
        types.by_name_.emplace(fold_name(program.types[i].name), i);
    }
    if (auto problem = detail::ProgramChecker{types, limits}.check()) {
        return Unexpected<Problem>{std::move(*problem)};
    }
    return types;
}

const DerivedType* ProgramTypes::find(std::string_view name) const
{
    const auto found = by_name_.find(fold_name(name));
    return found == by_name_.end() ? nullptr : &program_->types[found->second];
}

ResolvedType ProgramTypes::resolve(const TypeUse& use) const
{
    ResolvedType result;
    const TypeUse* at = &use;
    while (true) {
        result.dimensions.insert(result.dimensions.end(), at->dimensions.begin(),
                                 at->dimensions.end());
        if (at->subrange && !result.subrange) {
            result.subrange = at->subrange;
        }
        if (at->type_name.empty()) {
            result.elementary = at->elementary;
            result.string_length = length_of(*at);
            return result;
        }
        const DerivedType& type = *find(at->type_name);
        if (result.initial == nullptr && !type.initial.empty()) {
            result.initial = &type.initial;
        }
        if (type.kind != DerivedType::Kind::Alias) {
            result.kind = kind_of(type.kind);
            result.elementary = ElementaryType::Dint;
            result.type = &type;
            return result;
        }
        at = &type.alias;
    }
}

std::uint64_t ProgramTypes::size_of(const TypeUse& use) const
{
    return layout_of(use, Memory::Cpu).size;
}

std::uint64_t ProgramTypes::image_size_of(const TypeUse& use) const
{
    return layout_of(use, Memory::Image).size;
}

ProgramTypes::Layout ProgramTypes::layout_of(const TypeUse& use, Memory memory) const
{
    const ResolvedType type = resolve(use);
    const Layout one = layout_of_one(type, memory);
    const bool has_bits = memory == Memory::Cpu && type.kind == ResolvedType::Kind::Elementary &&
                          type.elementary == ElementaryType::Bool && type.is_array();
    const std::uint64_t count =
        has_bits ? rounded_up(type.elements(), bits_of_word) / bits_of_word : type.elements();
    return {saturating_product(one.size, count), one.alignment};
}

ProgramTypes::Layout ProgramTypes::layout_of_one(const ResolvedType& type, Memory memory) const
{
    switch (type.kind) {
    case ResolvedType::Kind::Elementary:
        return layout_of(type.elementary, type.string_length, memory);
    case ResolvedType::Kind::Enumeration:
        return layout_of(ElementaryType::Dint, 0, memory);
    default:
        const Layouts& both =
            layouts_[static_cast<std::size_t>(type.type - program_->types.data())];
        return memory == Memory::Cpu ? both.in_cpu : both.in_image;
    }
}

ProgramTypes::Layout ProgramTypes::layout_of(ElementaryType type, std::uint32_t length,
                                             Memory memory)
{
    if (is_text(type)) {
        return memory == Memory::Cpu
                   ? Layout{text_size_in_cpu(type, length), is_wide(type) ? 2U : 1U}
                   : Layout{
                         rounded_up(size_of_length + text_bytes_of(type, length), size_of_length),
                         size_of_length};
    }
    const bool is_byte = memory == Memory::Image && type == ElementaryType::Bool;
    const std::uint64_t size = is_byte ? 1 : controller::size_of(type);
    return {size, size};
}

ProgramTypes::Layouts ProgramTypes::layouts_of_type(const DerivedType& type) const
{
    return {layout_of_members(type, Memory::Cpu), layout_of_members(type, Memory::Image)};
}

ProgramTypes::Layout ProgramTypes::layout_of_members(const DerivedType& type, Memory memory) const
{
    Layout all;
    for (const Member& member : type.members) {
        const Layout one = layout_of(member.type, memory);
        const bool is_union = type.kind == DerivedType::Kind::Union;
        const std::uint64_t place = is_union ? 0 : rounded_up(all.size, one.alignment);
        all.size = std::max(all.size, std::min(max_size, place + one.size));
        all.alignment = std::max(all.alignment, one.alignment);
    }
    all.size = std::min(max_size, rounded_up(all.size, all.alignment));
    return all;
}

std::uint32_t size_of(ElementaryType type)
{
    return elementary_rows[static_cast<std::size_t>(type)].size;
}

BuiltInType built_in_type_of(ElementaryType type, ElementaryTypes choice)
{
    if (choice == ElementaryTypes::Plcopen && type == ElementaryType::Time) {
        return BuiltInType::Int64;
    }
    if (choice == ElementaryTypes::Plcopen && type == ElementaryType::TimeOfDay) {
        return BuiltInType::UInt32;
    }
    if (choice == ElementaryTypes::Plcopen && type == ElementaryType::Ltime) {
        return BuiltInType::Int64;
    }
    if (choice == ElementaryTypes::Plcopen && type == ElementaryType::LtimeOfDay) {
        return BuiltInType::UInt64;
    }
    return elementary_rows[static_cast<std::size_t>(type)].built_in;
}

std::string_view name(ElementaryType type)
{
    return elementary_rows[static_cast<std::size_t>(type)].name;
}

std::string fold_name(std::string_view name)
{
    std::string folded{name};
    std::transform(folded.begin(), folded.end(), folded.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return folded;
}

} // namespace busbar::controller
