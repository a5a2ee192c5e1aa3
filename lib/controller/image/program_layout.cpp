#include "program_layout.hpp"

#include <busbar/core/text.hpp>

namespace busbar::controller::detail {

namespace {

/// Words for the refusals of ImageLayout and ImageStructure.
std::string text_of_refusal(StatusCode status)
{
    if (status == status::Bad_OutOfMemory) {
        return "takes more bytes than a process image can have";
    }
    return "has more dimensions, members or levels than a process image can have";
}

std::string printable_name(const std::string& name)
{
    constexpr std::size_t enough = 60;
    return printable(name.substr(0, enough));
}

} // namespace

Configured<server::ImageVariable> ProgramLayout::variable(const ResolvedType& type)
{
    server::ImageVariable made;
    for (const Bounds& bounds : type.dimensions) {
        made.dimensions.push_back(static_cast<std::uint32_t>(bounds.upper - bounds.lower + 1));
    }
    switch (type.kind) {
    case ResolvedType::Kind::Union:
        return misconfigured("", "is a union, which has no place in a process image");
    case ResolvedType::Kind::Structure: {
        auto inner = structure(*type.type);
        if (!inner) {
            return Unexpected<Problem>{std::move(inner.error())};
        }
        made.type = BuiltInType::ExtensionObject;
        made.structure = std::move(*inner);
        break;
    }
    default:
        made.type = built_in_type_of(type.elementary, elementary_);
        made.capacity = type.text_bytes();
        made.max_units = is_wide(type.elementary) ? type.string_length : 0;
        if (type.subrange) {
            made.range = server::ImageRange{type.subrange->lower, type.subrange->upper};
        }
    }
    return made;
}

Configured<ProgramLayout::Structure> ProgramLayout::structure(const DerivedType& type)
{
    if (const auto found = structures_.find(&type); found != structures_.end()) {
        return found->second;
    }
    std::vector<server::ImageVariable> members;
    for (const ResolvedType& member : types_->members(type)) {
        auto made = variable(member);
        if (!made) {
            Problem problem = std::move(made.error());
            problem.where = "." + printable_name(type.members[members.size()].name) + problem.where;
            return Unexpected<Problem>{std::move(problem)};
        }
        members.push_back(std::move(*made));
    }
    auto made = server::ImageStructure::create(encoding_of_(type), members);
    if (!made) {
        return misconfigured("", text_of_refusal(made.error()));
    }
    return structures_.emplace(&type, std::move(*made)).first->second;
}

std::string place_of_variable(const Program& program, std::size_t index)
{
    const GlobalVariable& variable = program.variables[index];
    std::string where;
    if (variable.place.line != 0) {
        where = std::to_string(variable.place.line) + ":" + std::to_string(variable.place.column) +
                ": ";
    }
    return where + "variables[" + std::to_string(index) + "] (" + printable_name(variable.name) +
           ")";
}

} // namespace busbar::controller::detail
