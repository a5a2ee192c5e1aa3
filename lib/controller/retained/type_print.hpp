#pragma once

#include <cstdint>
#include <unordered_map>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Prints of types: the same for types whose values lie in the same way in an image and mean the
/// same, and otherwise others, but for the chance of 1 to 2^64. Names of types do not count, those
/// of members and enumerators do.
class TypePrints {
public:
    explicit TypePrints(const ProgramTypes& types,
                        ElementaryTypes elementary = ElementaryTypes::BuiltIn)
        : types_{&types}, elementary_{elementary}
    {
    }

    [[nodiscard]] std::uint64_t print(const TypeUse& use);

private:
    /// Each once, so that types that lie twice in one another cost no more than others.
    [[nodiscard]] std::uint64_t print_of(const DerivedType& type);

    const ProgramTypes* types_;
    ElementaryTypes elementary_;
    std::unordered_map<const DerivedType*, std::uint64_t> known_;
};

} // namespace busbar::controller::detail
