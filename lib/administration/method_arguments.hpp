#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/core/extension_object.hpp>
#include <busbar/core/variant.hpp>
#include <busbar/model/address_space.hpp>
#include <busbar/server/method_table.hpp>
#include <busbar/types/data_types.hpp>

/// Access to the arguments of administration's Methods.
namespace busbar::administration::detail {

/// Returns an argument's text, empty for null; valid as long as the call.
[[nodiscard]] std::string_view text_view(const server::MethodCall& call, std::size_t index);
[[nodiscard]] inline std::string text_input(const server::MethodCall& call, std::size_t index)
{
    return std::string{text_view(call, index)};
}

/// Returns an argument's bytes, empty for null; valid as long as the call.
[[nodiscard]] std::span<const std::byte> bytes_input(const server::MethodCall& call,
                                                     std::size_t index);

/// Returns the structure in the first argument; an empty one for another type, which the Method's
/// InputArguments do not allow.
template <typename T>
[[nodiscard]] T structure_input(const server::MethodCall& call)
{
    const auto* const object = call.inputs()[0].get_if<ExtensionObject>();
    T result;
    if (object == nullptr) {
        return result;
    }
    if (const T* const decoded = object->get_if<T>()) {
        result = *decoded;
    } else if (auto found = binary::structure_of<T>(*object)) {
        result = *std::move(found);
    }
    // The analyzer cannot follow a count of references.
    return result; // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks)
}

/// Makes an array of structures; an empty list does not become null.
template <typename T, typename From>
[[nodiscard]] Variant structures(const std::vector<From>& list)
{
    Array<ExtensionObject> objects;
    objects.clear();
    for (const From& each : list) {
        objects.push_back(ExtensionObject::from(T{each}));
    }
    return Variant{std::move(objects)};
}

/// Makes an array of Strings; an empty list does not become null.
[[nodiscard]] Variant texts(const std::vector<std::string>& list);

/// Makes an array of NodeIds; an empty list does not become null.
[[nodiscard]] Variant node_ids(const std::vector<NodeId>& ids);

/// Returns the Property InputArguments or OutputArguments of a Method in namespace 0.
[[nodiscard]] Array<Argument> declared_arguments(const model::AddressSpace& space,
                                                 model::NodeIndex method,
                                                 std::string_view property);

/// Returns the outputs of a Method that has a single one.
[[nodiscard]] inline Array<Variant> one_output(Variant value)
{
    Array<Variant> outputs;
    outputs.push_back(std::move(value));
    return outputs;
}

} // namespace busbar::administration::detail
