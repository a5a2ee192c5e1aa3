#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Looks over the initial values of a program whose types are checked, in a time that grows with
/// the values and not with the types' nesting.
class InitialChecker {
public:
    explicit InitialChecker(const ProgramTypes& types) : types_{&types}, program_{&types.program()}
    {
    }

    /// The first thing that is wrong.
    [[nodiscard]] std::optional<Problem> check();

private:
    using Found = std::optional<Problem>;

    /// Of a structure, union or enumeration: its members or values by name in small letters.
    struct Names {
        std::unordered_map<std::string, std::size_t> index{};
        /// Of each member, once it is looked at.
        std::vector<std::optional<ResolvedType>> types{};
        /// The aggregate in which each was found last.
        std::vector<std::uint64_t> last_found{};
    };
    /// A member, or an element of an array.
    struct Step {
        const std::string* member{nullptr};
        std::uint64_t element{0};
    };

    [[nodiscard]] Found check_type(const DerivedType& type);
    [[nodiscard]] Found check_use(const TypeUse& use, const InitialValue& initial,
                                  const ProgramPlace& place);
    /// `level` dimensions of the type are behind us.
    [[nodiscard]] Found check_value(const ResolvedType& type, std::size_t level,
                                    const InitialValue& value);
    [[nodiscard]] Found check_list(const ResolvedType& type, std::size_t level,
                                   const InitialValue& value);
    [[nodiscard]] Found check_element(const ResolvedType& type, std::size_t level,
                                      const InitialValue& part, bool is_of_lists);
    [[nodiscard]] Found check_aggregate(const DerivedType& type, const InitialValue& value);
    [[nodiscard]] Found check_member(const DerivedType& type, Names& names, std::uint64_t aggregate,
                                     const InitialValue& part);
    [[nodiscard]] Found check_enumerator(const DerivedType& type, const InitialValue& value);
    [[nodiscard]] Names& names_of(const DerivedType& type);
    [[nodiscard]] Problem problem(const InitialValue& value, std::string text) const;

    const ProgramTypes* types_;
    const Program* program_;
    std::unordered_map<const DerivedType*, Names> names_{};
    std::uint64_t aggregates_{0};
    /// What is looked at.
    std::string root_{};
    ProgramPlace place_{};
    std::vector<Step> steps_{};
};

} // namespace busbar::controller::detail
