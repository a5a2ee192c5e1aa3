#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// What one Argument of a Method may be; stays valid without the Method, as types stay.
struct ArgumentRule {
    model::NodeIndex data_type{model::no_node};
    std::int32_t value_rank{-1};
    Array<std::uint32_t> array_dimensions;
};

/// What a Method takes and returns.
struct MethodSignature {
    std::vector<ArgumentRule> inputs;
    std::vector<ArgumentRule> outputs;
};

/// What the properties InputArguments and OutputArguments say (Part 3, 5.7.2); nothing if they are
/// not there. Bad_InternalError for a property that says something else.
[[nodiscard]] Result<MethodSignature> read_signature(const model::AddressSpace& space,
                                                     const binary::TypeRegistry& types,
                                                     model::NodeIndex method);

/// Good, or Bad_TypeMismatch: data type, value rank and array dimensions.
[[nodiscard]] StatusCode check_argument(const model::AddressSpace& space, const ArgumentRule& rule,
                                        const Variant& value);

/// True if there are as many values as rules and each is good.
[[nodiscard]] bool fit_arguments(const model::AddressSpace& space,
                                 std::span<const ArgumentRule> rules,
                                 std::span<const Variant> values);

} // namespace busbar::server::detail
