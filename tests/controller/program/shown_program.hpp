#pragma once

#include <string>

#include <busbar/controller/checked_program.hpp>

/// What is served of a program, in a line.
namespace busbar::controller::test {

[[nodiscard]] inline std::string shown(const ProgramTypes& types, const TypeUse& use)
{
    const ResolvedType type = types.resolve(use);
    std::string text;
    for (const Bounds& bounds : type.dimensions) {
        text += "[" + std::to_string(bounds.lower) + ".." + std::to_string(bounds.upper) + "]";
    }
    if (type.kind == ResolvedType::Kind::Elementary) {
        text += name(type.elementary);
        text += type.string_length > 1 ? "(" + std::to_string(type.string_length) + ")" : "";
        return type.subrange ? text + "{" + std::to_string(type.subrange->lower) + ".." +
                                   std::to_string(type.subrange->upper) + "}"
                             : text;
    }
    text += type.kind == ResolvedType::Kind::Union ? "|" : "(";
    const char* separator = "";
    for (const Enumerator& one : type.type->enumerators) {
        text += separator + one.name + "=" + std::to_string(one.value);
        separator = " ";
    }
    for (const Member& one : type.type->members) {
        text += separator + one.name + " " + shown(types, one.type);
        separator = ", ";
    }
    return text + (type.kind == ResolvedType::Kind::Union ? "|" : ")");
}

/// Shows each variable as "speed INT; part (A INT, B BOOL)", and then the reason for which each
/// variable or type that is left out is.
[[nodiscard]] inline std::string shown(Configured<Program> program)
{
    const auto checked = std::move(program).and_then(
        [](Program read) { return CheckedProgram::create(std::move(read), Unserved::LeaveOut); });
    if (!checked) {
        return std::string{text(checked.error())};
    }
    std::string all;
    for (const GlobalVariable& each : (*checked)->program().variables) {
        all += (all.empty() ? "" : "; ") + each.name + " " + shown((*checked)->types(), each.type);
    }
    for (const LeftOut& each : (*checked)->program().left_out) {
        all += (all.empty() ? "" : "; ") + std::string{"- "} + each.declared.name + " " +
               each.problem.text;
    }
    return all;
}

} // namespace busbar::controller::test
