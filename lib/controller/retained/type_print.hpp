#pragma once

#include <cstdint>
#include <unordered_map>

#include <busbar/controller/program_types.hpp>

namespace busbar::controller::detail {

/// Computes fingerprints of types. They are equal for types whose values have the same layout in an
/// image and the same meaning, and differ otherwise, with a chance of 1 to 2^64 for a mistake.
/// Names of members and enumerators matter, names of types do not.
class TypePrints {
public:
    explicit TypePrints(const ProgramTypes& types,
                        ElementaryTypes elementary = ElementaryTypes::BuiltIn)
        : types_{&types}, elementary_{elementary}
    {
    }

    [[nodiscard]] std::uint64_t print(const TypeUse& use);

private:
    /// Computes each print once, so that types nested twice cost no more than others.
    [[nodiscard]] std::uint64_t print_of(const DerivedType& type);

    const ProgramTypes* types_;
    ElementaryTypes elementary_;
    std::unordered_map<const DerivedType*, std::uint64_t> known_;
};

} // namespace busbar::controller::detail
