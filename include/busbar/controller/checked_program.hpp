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

/// A program whose types and initial values were found to be right, so that nothing looks at them a
/// second time. It never changes: any thread may read it.
class BUSBAR_API CheckedProgram {
    struct Key {};

public:
    /// Takes time with the program: 10,000 variables are some milliseconds. The problem is that of
    /// ProgramTypes, or of an initial value that does not fit its type.
    [[nodiscard]] static Configured<std::shared_ptr<const CheckedProgram>> create(Program program);
    CheckedProgram(Key, Program program) : program_{std::move(program)} {}
    CheckedProgram(const CheckedProgram&) = delete;
    CheckedProgram& operator=(const CheckedProgram&) = delete;

    [[nodiscard]] const Program& program() const { return program_; }
    [[nodiscard]] const ProgramTypes& types() const { return *types_; }
    /// The variable of this name, as fold_name() has it; null if there is none.
    [[nodiscard]] const GlobalVariable* variable(const std::string& folded) const
    {
        const auto found = variables_.find(folded);
        return found != variables_.end() ? found->second : nullptr;
    }

private:
    Program program_;
    /// Looks at program_.
    std::optional<ProgramTypes> types_;
    /// By their folded names.
    std::unordered_map<std::string, const GlobalVariable*> variables_;
};

} // namespace busbar::controller
