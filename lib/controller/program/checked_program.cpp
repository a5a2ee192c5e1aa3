#include <busbar/controller/checked_program.hpp>

#include <busbar/controller/program_initial.hpp>

namespace busbar::controller {

Configured<std::shared_ptr<const CheckedProgram>> CheckedProgram::create(Program program)
{
    const auto checked = std::make_shared<CheckedProgram>(Key{}, std::move(program));
    auto types = ProgramTypes::create(checked->program_);
    if (!types) {
        return Unexpected{std::move(types).error()};
    }
    checked->types_ = std::move(*types);
    if (auto initial = check_initial_values(*checked->types_); !initial) {
        return Unexpected{std::move(initial).error()};
    }
    checked->variables_.reserve(checked->program_.variables.size());
    for (const GlobalVariable& each : checked->program_.variables) {
        checked->variables_.emplace(fold_name(each.name), &each);
    }
    return checked;
}

} // namespace busbar::controller
