#include "method_signature.hpp"

#include <busbar/binary/codec.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::server::detail {

namespace {

Result<std::vector<ArgumentRule>> to_rules(const model::AddressSpace& space,
                                           const Variant& descriptions)
{
    std::vector<ArgumentRule> rules;
    if (descriptions.is_null()) {
        return rules;
    }
    const auto* const objects = descriptions.array_if<ExtensionObject>();
    if (objects == nullptr) {
        return fail(status::Bad_InternalError);
    }
    rules.reserve(objects->size());
    for (const ExtensionObject& object : *objects) {
        const auto argument = binary::structure_of<Argument>(object);
        if (!argument) {
            return fail(status::Bad_InternalError);
        }
        rules.push_back(
            {space.find(argument->data_type), argument->value_rank, argument->array_dimensions});
    }
    return rules;
}

Result<std::vector<ArgumentRule>> read_rules(const model::AddressSpace& space,
                                             const binary::TypeRegistry& types,
                                             model::NodeIndex method, const char* property_name)
{
    model::NodeIndex property = model::no_node;
    space.for_each_child(method, space.find(id::HasProperty), true, QualifiedName{0, property_name},
                         [&](model::NodeIndex child) {
                             property = child;
                             return false;
                         });
    if (property == model::no_node) {
        return std::vector<ArgumentRule>{};
    }
    return to_rules(space, space.value(property, &types));
}

} // namespace

Result<MethodSignature> read_signature(const model::AddressSpace& space,
                                       const binary::TypeRegistry& types, model::NodeIndex method)
{
    auto inputs = read_rules(space, types, method, "InputArguments");
    auto outputs = read_rules(space, types, method, "OutputArguments");
    if (!inputs || !outputs) {
        return fail(inputs ? outputs.error() : inputs.error());
    }
    return MethodSignature{std::move(*inputs), std::move(*outputs)};
}

StatusCode check_argument(const model::AddressSpace& space, const ArgumentRule& rule,
                          const Variant& value)
{
    // Write accepts a ByteString for an array of Byte (Part 4, 5.11.4.2), Call does not: the code
    // that carries the Method out relies on the type.
    const bool is_byte_string = !value.is_null() && value.type() == BuiltInType::ByteString;
    if (is_byte_string && space.built_in_type_of(rule.data_type) == BuiltInType::Byte) {
        return status::Bad_TypeMismatch;
    }
    return space.check_value(value, rule.data_type, rule.value_rank, rule.array_dimensions.span());
}

bool fit_arguments(const model::AddressSpace& space, std::span<const ArgumentRule> rules,
                   std::span<const Variant> values)
{
    bool fits = values.size() == rules.size();
    for (std::size_t i = 0; fits && i < rules.size(); ++i) {
        fits = check_argument(space, rules[i], values[i]).is_good();
    }
    return fits;
}

} // namespace busbar::server::detail
