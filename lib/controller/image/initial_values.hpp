#pragma once

#include <cstddef>
#include <cstdint>

#include <busbar/controller/program.hpp>
#include <busbar/controller/program_types.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::controller::detail {

/// Writes initial values, which have passed InitialChecker, into the memory of an image. Its
/// functions return false if the type that something is published as does not have the value, which
/// is then left out.
class InitialValues {
public:
    explicit InitialValues(const ProgramTypes& types) : types_{&types} {}

    /// Stores the value of a variable or member, which lies at `to`: `own`, or what its type says.
    [[nodiscard]] bool store(const ResolvedType& type, const InitialValue& own,
                             const server::ImagePlace& place, std::byte* to) const;

private:
    /// The variable or member that is filled; of an array its first element.
    struct Target {
        const ResolvedType& type;
        const server::ImagePlace& place;
        std::byte* to;
    };

    [[nodiscard]] bool store_default(const Target& target) const;
    /// Applies the values of the types, the innermost first: each to one value of its type, which
    /// is then copied to the others that are elements of one value of the next type.
    [[nodiscard]] bool apply_types(const Target& target) const;
    [[nodiscard]] bool apply(const Target& target, const InitialValue& value) const;
    /// Fills elements from index `first` on by a list below `level` dimensions. A list of lists has
    /// one for each index, of which a short one leaves the rest of its elements alone.
    [[nodiscard]] bool apply_list(const Target& array, const InitialValue& list, std::size_t level,
                                  std::uint64_t first) const;
    /// Fills `count` elements from index `first` on with one value.
    [[nodiscard]] bool apply_repeated(const Target& array, const InitialValue& value,
                                      std::uint64_t first, std::uint64_t count) const;
    [[nodiscard]] bool apply_one(const Target& target, const InitialValue& value) const;
    [[nodiscard]] bool apply_members(const Target& target, const InitialValue& value) const;

    const ProgramTypes* types_;
};

/// Stores a number, truth value or date as a value of `type`. False, with nothing changed, if the
/// value is of another kind or does not fit.
[[nodiscard]] bool put_initial_number(BuiltInType type, const Variant& value, std::byte* to);

/// Converts a number of a program to values of type `built_in`: milliseconds of a TIME are rounded,
/// a TIME_OF_DAY becomes milliseconds since midnight. Other values, and those that cannot be
/// converted, stay as they are.
[[nodiscard]] Variant as_published(ElementaryType type, BuiltInType built_in, const Variant& value);

} // namespace busbar::controller::detail
