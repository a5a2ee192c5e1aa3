#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include <busbar/controller/program_types.hpp>
#include <busbar/core/problem.hpp>
#include <busbar/server/image_place.hpp>

namespace busbar::controller::detail {

/// Puts what a program declares variables to begin with into the memory of an image.
class InitialValues {
public:
    explicit InitialValues(const ProgramTypes& types) : types_{&types} {}

    using Found = std::optional<Problem>;

    /// A variable or member, which lies at `to`. The Problem's `where` begins behind its name.
    [[nodiscard]] Found store(const TypeUse& use, const InitialValue& own,
                              const server::ImagePlace& place, std::byte* to) const;

private:
    /// What is being filled: of an array its first element.
    struct Target {
        const ResolvedType& type;
        const server::ImagePlace& place;
        std::byte* to;
    };

    [[nodiscard]] Found store_default(const Target& target) const;
    [[nodiscard]] Found apply(const Target& target, const InitialValue& value) const;
    /// From the element `next` on, which is counted on.
    [[nodiscard]] Found apply_list(const Target& array, const InitialValue& list,
                                   std::uint64_t& next) const;
    [[nodiscard]] Found apply_repeated(const Target& array, const InitialValue& part,
                                       std::uint64_t& next) const;
    [[nodiscard]] Found apply_one(const Target& target, const InitialValue& value) const;
    [[nodiscard]] Found apply_members(const Target& target, const InitialValue& value) const;

    const ProgramTypes* types_;
};

} // namespace busbar::controller::detail
