#pragma once

#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Looks a program over before anything follows its names.
class ProgramChecker {
public:
    ProgramChecker(ProgramTypes& types, const ProgramLimits& limits)
        : types_{&types}, program_{&types.program()}, limits_{&limits}
    {
    }

    /// The first thing that is wrong.
    [[nodiscard]] std::optional<Problem> check();

private:
    using Found = std::optional<Problem>;

    [[nodiscard]] Found check_counts() const;
    [[nodiscard]] Found check_type(std::size_t index) const;
    [[nodiscard]] Found check_members(const DerivedType& type, const std::string& where) const;
    [[nodiscard]] Found check_enumerators(const DerivedType& type, const std::string& where) const;
    [[nodiscard]] Found check_use(const TypeUse& use, const std::string& where,
                                  const ProgramPlace& place) const;
    /// With those of the types that are followed, which are checked already.
    [[nodiscard]] Found check_dimensions(const TypeUse& use, const std::string& where,
                                         const ProgramPlace& place) const;
    /// Types that lie in one another: none contains itself. Notes what each takes.
    [[nodiscard]] Found check_nesting();
    /// `level` types are around it and itself.
    [[nodiscard]] Found measure(std::size_t index, std::size_t level);
    [[nodiscard]] Found measure_inner(const DerivedType& type, std::size_t level,
                                      std::size_t& below);
    [[nodiscard]] Found check_variables() const;
    [[nodiscard]] Found check_name(const std::string& name, const std::string& where,
                                   const ProgramPlace& place) const;

    ProgramTypes* types_;
    const Program* program_;
    const ProgramLimits* limits_;
    /// Of each type how many lie within one another, with itself; or a state of measure().
    std::vector<std::size_t> depths_;
};

} // namespace busbar::controller::detail
