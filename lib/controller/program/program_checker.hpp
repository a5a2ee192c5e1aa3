#pragma once

#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Checks a program before its names are resolved.
class ProgramChecker {
public:
    ProgramChecker(ProgramTypes& types, const ProgramLimits& limits)
        : types_{&types}, program_{&types.program()}, limits_{&limits}
    {
    }

    /// Returns the first problem.
    [[nodiscard]] std::optional<Problem> check();
    /// Returns what SIZEOF of the declared types means, by their folded names, in a program that is
    /// not checked; without those that use one of `unsettled` or have a problem.
    [[nodiscard]] static std::unordered_map<std::string, std::uint64_t>
    sizes(const Program& program, const std::unordered_set<std::string>& unsettled);

    using Found = std::optional<Problem>;

    /// Checks a type by itself: names, and whether the types that it uses are declared.
    [[nodiscard]] Found check_type(std::size_t index) const;
    /// Prepares check_nesting_of(); all types must have passed check_type().
    void prepare_nesting();
    /// Checks that the type does not contain itself, and notes its size.
    [[nodiscard]] Found check_nesting_of(std::size_t index);
    /// Lays out all types, of which none has a problem.
    void lay_out_types() { static_cast<void>(check_nesting()); }
    /// Checks a variable; all types must have passed the checks. `names` are the folded names of
    /// variables before it, to which its own is added.
    [[nodiscard]] Found check_variable(std::size_t index,
                                       std::unordered_set<std::string>& names) const;

private:
    [[nodiscard]] Found check_counts() const;
    [[nodiscard]] Found check_members(const DerivedType& type, const std::string& where) const;
    [[nodiscard]] Found check_enumerators(const DerivedType& type, const std::string& where) const;
    [[nodiscard]] Found check_use(const TypeUse& use, const std::string& where,
                                  const ProgramPlace& place) const;
    /// Checks the number of dimensions, including those of the types that it refers to.
    [[nodiscard]] Found check_dimensions(const ResolvedType& type, const std::string& where,
                                         const ProgramPlace& place) const;
    [[nodiscard]] Found check_nesting();
    /// Measures a type that is nested in `level` types, itself included.
    [[nodiscard]] Found measure(std::size_t index, std::size_t level);
    [[nodiscard]] Found measure_inner(const DerivedType& type, std::size_t level,
                                      std::size_t& below);
    /// Remembers the problem of a type whose inner types cannot be measured, and returns it.
    [[nodiscard]] Problem remember(std::size_t index, std::size_t level, Problem found);
    [[nodiscard]] Found check_variables() const;
    [[nodiscard]] Found check_name(const std::string& name, const std::string& where,
                                   const ProgramPlace& place) const;

    ProgramTypes* types_;
    const Program* program_;
    const ProgramLimits* limits_;
    /// For each type the number of types nested in it, itself included; or a state of measure().
    std::vector<std::size_t> depths_;
    /// The problems of types that cannot be measured, so that each is measured once; without those
    /// that depend on the types around it.
    std::unordered_map<std::size_t, Problem> failures_{};
    /// The problem that is found is too many types around one.
    bool is_too_deep_{false};
    /// The type that was found to contain itself, while a type within it is left.
    std::optional<std::size_t> repeated_{};
};

} // namespace busbar::controller::detail
