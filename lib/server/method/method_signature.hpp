#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <busbar/binary/type_registry.hpp>
#include <busbar/core/result.hpp>
#include <busbar/model/address_space.hpp>

namespace busbar::server::detail {

/// The rule for one Argument of a Method; stays valid without the Method, as types are never
/// removed.
struct ArgumentRule {
    model::NodeIndex data_type{model::no_node};
    std::int32_t value_rank{-1};
    Array<std::uint32_t> array_dimensions;
};

/// The inputs and outputs of a Method.
struct MethodSignature {
    std::vector<ArgumentRule> inputs;
    std::vector<ArgumentRule> outputs;
};

/// Reads the properties InputArguments and OutputArguments (Part 3, 5.7.2); empty if they do not
/// exist. Bad_InternalError for a property with another content.
[[nodiscard]] Result<MethodSignature> read_signature(const model::AddressSpace& space,
                                                     const binary::TypeRegistry& types,
                                                     model::NodeIndex method);

/// Returns Good, or Bad_TypeMismatch: checks data type, value rank and array dimensions.
[[nodiscard]] StatusCode check_argument(const model::AddressSpace& space, const ArgumentRule& rule,
                                        const Variant& value);

/// True if there are as many values as rules and each fits.
[[nodiscard]] bool fit_arguments(const model::AddressSpace& space,
                                 std::span<const ArgumentRule> rules,
                                 std::span<const Variant> values);

} // namespace busbar::server::detail
