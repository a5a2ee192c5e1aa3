#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <busbar/controller/program.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::controller::detail {

/// Writes the declared initial values of a program's variables into the memory of an image.
class InitialValues {
public:
    explicit InitialValues(const ProgramTypes& types) : types_{&types} {}

    using Found = std::optional<Problem>;

    /// Stores the value of a variable or member, which lies at `to`. The `where` of a Problem
    /// begins after its name.
    [[nodiscard]] Found store(const TypeUse& use, const InitialValue& own,
                              const server::ImagePlace& place, std::byte* to) const;

private:
    /// The variable or member that is filled; of an array its first element.
    struct Target {
        const ResolvedType& type;
        const server::ImagePlace& place;
        std::byte* to;
    };

    [[nodiscard]] Found store_default(const Target& target) const;
    [[nodiscard]] Found apply(const Target& target, const InitialValue& value) const;
    /// Fills elements from index `next` on, which it advances.
    [[nodiscard]] Found apply_list(const Target& array, const InitialValue& list,
                                   std::uint64_t& next) const;
    [[nodiscard]] Found apply_repeated(const Target& array, const InitialValue& part,
                                       std::uint64_t& next) const;
    [[nodiscard]] Found apply_one(const Target& target, const InitialValue& value) const;
    [[nodiscard]] Found apply_members(const Target& target, const InitialValue& value) const;

    const ProgramTypes* types_;
};

/// Stores a number, truth value or date as a value of `type`. False, with nothing changed, if the
/// value is of another kind or does not fit.
[[nodiscard]] bool put_initial_number(BuiltInType type, const Variant& value, std::byte* to);

/// Converts a number of a program to values of type `built_in`: milliseconds of a TIME are rounded,
/// a TIME_OF_DAY becomes milliseconds since midnight. Other values, and those that cannot be
/// converted, stay as they are.
[[nodiscard]] Variant as_published(ElementaryType type, BuiltInType built_in, const Variant& value);

/// True also for values that are not integers.
[[nodiscard]] bool is_in_subrange(const Variant& value, const std::optional<Bounds>& subrange);

} // namespace busbar::controller::detail
