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
    return checked;
}

} // namespace busbar::controller
