#include "online_edit.hpp"

#include <string>
#include <utility>

#include "controller/program/program_problem.hpp"

namespace busbar::controller::detail {

namespace {

Unexpected<Problem> changed_online(const Program& edited, std::string where,
                                   const ProgramPlace& place, std::string what)
{
    return Unexpected<Problem>{
        problem_at(edited, std::move(where), place,
                   "already exists and " + std::move(what) +
                       "; this requires a download instead of an online edit")};
}

TypeUse use_of(const DerivedType& type)
{
    return {.type_name = type.name};
}

} // namespace

Configured<void> check_same_types(const ProgramTypes& before, const ProgramTypes& edited)
{
    const auto& types = edited.program().types;
    for (std::size_t i = 0; i < types.size(); ++i) {
        const DerivedType* const old = before.find(types[i].name);
        if (old != nullptr && before.print_of(use_of(*old)) != edited.print_of(use_of(types[i]))) {
            return changed_online(edited.program(), place_in("types", i, types[i].name),
                                  types[i].place, "was a different type");
        }
    }
    return {};
}

Configured<void> check_same_variables(const CheckedProgram& before, const CheckedProgram& edited)
{
    const auto& variables = edited.program().variables;
    for (std::size_t i = 0; i < variables.size(); ++i) {
        const GlobalVariable* const old = before.variable(fold_name(variables[i].name));
        if (old == nullptr) {
            continue;
        }
        const std::string where = place_in("variables", i, variables[i].name);
        if (old->is_constant != variables[i].is_constant) {
            return changed_online(edited.program(), where, variables[i].place,
                                  variables[i].is_constant ? "was not a constant"
                                                           : "was a constant");
        }
        if (before.types().print_of(old->type) != edited.types().print_of(variables[i].type)) {
            return changed_online(edited.program(), where, variables[i].place, "had another type");
        }
    }
    return {};
}

} // namespace busbar::controller::detail
