#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Moves to Program::left_out what makes ProgramTypes::create or check_initial_values fail, with
/// everything that uses a type that is left out. Takes time in proportion to the program.
class ProgramSieve {
public:
    /// Both must outlive it.
    ProgramSieve(Program& program, const ProgramLimits& limits);

    /// Only too many types or variables are a problem afterwards.
    void run();

private:
    using Found = std::optional<Problem>;
    using CheckType = std::function<Found(std::size_t index)>;

    /// Leaves out each type for which the check finds a problem, and those that use it.
    void sieve_types(const CheckType& check);
    /// Adds problems for the types that use one with a problem.
    void add_users(std::vector<Found>& problems) const;
    void leave_out_types(std::vector<Found>& problems);
    void sieve_variables();
    /// Notes why the type is left out, for those that use it.
    void remember(const LeftOut& one);
    /// Finds a use of a type that is left out.
    [[nodiscard]] Found check_use(const TypeUse& use, const std::string& where,
                                  const ProgramPlace& place) const;
    [[nodiscard]] Found check_uses(std::size_t index) const;

    Program* program_;
    const ProgramLimits* limits_;
    ProgramTypes types_;
    /// The reasons for which types are left out, keyed by their folded names.
    std::unordered_map<std::string, std::string> reasons_{};
};

} // namespace busbar::controller::detail
