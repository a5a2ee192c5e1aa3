#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include <busbar/controller/program.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/core/api.hpp>
#include <busbar/core/problem.hpp>

namespace busbar::controller {

/// A program whose types and initial values have been checked, so that they need no second check.
/// Immutable: any thread may read it.
class BUSBAR_API CheckedProgram {
    struct Key {};

public:
    /// Takes time in proportion to the program: some milliseconds for 10,000 variables. The problem
    /// is that of ProgramTypes, or an initial value that does not fit its type. With
    /// Unserved::LeaveOut a declaration with such a problem goes to Program::left_out, with all
    /// that use its type; the problem then is that there are too many types or variables.
    [[nodiscard]] static Configured<std::shared_ptr<const CheckedProgram>>
    create(Program program, Unserved unserved = Unserved::Refuse);
    CheckedProgram(Key, Program program) : program_{std::move(program)} {}
    CheckedProgram(const CheckedProgram&) = delete;
    CheckedProgram& operator=(const CheckedProgram&) = delete;

    [[nodiscard]] const Program& program() const { return program_; }
    [[nodiscard]] const ProgramTypes& types() const { return *types_; }
    /// Returns the variable whose name is `folded` as fold_name() returns it; null if there is
    /// none.
    [[nodiscard]] const GlobalVariable* variable(const std::string& folded) const
    {
        const auto found = variables_.find(folded);
        return found != variables_.end() ? found->second : nullptr;
    }

private:
    Program program_;
    /// Refers to program_.
    std::optional<ProgramTypes> types_;
    /// Keyed by the folded names.
    std::unordered_map<std::string, const GlobalVariable*> variables_;
};

} // namespace busbar::controller
