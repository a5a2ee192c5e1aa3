#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Checks the initial values of a program whose types are checked. Takes time in proportion to the
/// values, not to the nesting of types.
class InitialChecker {
public:
    explicit InitialChecker(const ProgramTypes& types) : types_{&types}, program_{&types.program()}
    {
    }

    /// Returns the first problem.
    [[nodiscard]] std::optional<Problem> check();
    /// Returns the first problem of one type or variable.
    [[nodiscard]] std::optional<Problem> check_type(std::size_t index);
    [[nodiscard]] std::optional<Problem> check_variable(std::size_t index);

private:
    using Found = std::optional<Problem>;

    /// Members or values of a structure, union or enumeration, by name in small letters.
    struct Names {
        std::unordered_map<std::string, std::size_t> index{};
        /// The aggregate in which each member was found last.
        std::vector<std::uint64_t> last_found{};
    };
    /// A step to a member or an element.
    struct Step {
        const std::string* member{nullptr};
        std::uint64_t element{0};
    };

    [[nodiscard]] Found check_type(const DerivedType& type);
    [[nodiscard]] Found check_use(const TypeUse& use, const InitialValue& initial,
                                  const ProgramPlace& place);
    /// Checks the value below `level` dimensions of the type.
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
    /// The variable or member that is being checked.
    std::string root_{};
    ProgramPlace place_{};
    std::vector<Step> steps_{};
};

/// Tells whether a value without parts suits the elementary type: its kind, range, subrange and
/// length.
[[nodiscard]] bool is_of_type(const InitialValue& value, const ResolvedType& type);

/// Describes a value: "70000", "a text of 6 bytes", "T#5ms".
[[nodiscard]] std::string value_words(const InitialValue& value);
/// Describes a type: "a value of INT (0..100)".
[[nodiscard]] std::string type_words(const ResolvedType& type);

} // namespace busbar::controller::detail
