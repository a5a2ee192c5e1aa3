#include <busbar/controller/checked_program.hpp>

#include <busbar/controller/program_initial.hpp>

#include "leaving_out.hpp"

namespace busbar::controller {

namespace {

Configured<ProgramTypes> checked_types(const Program& program)
{
    return ProgramTypes::create(program).and_then([](ProgramTypes types) {
        return check_initial_values(types).transform([&] { return std::move(types); });
    });
}

} // namespace

Configured<std::shared_ptr<const CheckedProgram>> CheckedProgram::create(Program program,
                                                                         Unserved unserved)
{
    const auto checked = std::make_shared<CheckedProgram>(Key{}, std::move(program));
    auto types = checked_types(checked->program_);
    if (!types && unserved == Unserved::LeaveOut) {
        detail::ProgramSieve{checked->program_, {}}.run();
        types = checked_types(checked->program_);
    }
    if (!types) {
        return Unexpected{std::move(types).error()};
    }
    checked->types_ = std::move(*types);
    checked->variables_.reserve(checked->program_.variables.size());
    for (const GlobalVariable& each : checked->program_.variables) {
        checked->variables_.emplace(fold_name(each.name), &each);
    }
    return checked;
}

} // namespace busbar::controller
