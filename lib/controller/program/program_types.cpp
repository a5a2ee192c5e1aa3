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

std::uint32_t length_of(const TypeUse& use)
{
    if (use.elementary == ElementaryType::Char || use.elementary == ElementaryType::Wchar) {
        return 1;
    }
    return is_text(use.elementary) ? use.string_length : 0;
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

Configured<ProgramTypes> ProgramTypes::create(const Program& program, const ProgramLimits& limits)
{
    ProgramTypes types{program};
    if (auto problem = detail::ProgramChecker{types, limits}.check()) {
        return Unexpected<Problem>{std::move(*problem)};
    }
    return types;
}

void ProgramTypes::index()
{
    by_name_.clear();
    for (std::size_t i = 0; i < program_->types.size(); ++i) {
        by_name_.emplace(fold_name(program_->types[i].name), i);
    }
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
        if (!type.initial.empty()) {
            result.initials.push_back({&type.initial, result.dimensions.size()});
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
