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

/// What Methods of the administration get and give.
namespace busbar::administration::detail {

/// The text of an argument; empty if it is null. Valid as long as the call.
[[nodiscard]] std::string_view text_view(const server::MethodCall& call, std::size_t index);
[[nodiscard]] inline std::string text_input(const server::MethodCall& call, std::size_t index)
{
    return std::string{text_view(call, index)};
}

/// The bytes of an argument; empty if it is null. Valid as long as the call.
[[nodiscard]] std::span<const std::byte> bytes_input(const server::MethodCall& call,
                                                     std::size_t index);

/// The structure of the first argument; empty if it is another one, which the Method's
/// InputArguments do not let through.
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

/// An array that is empty rather than null.
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

/// The same of texts.
[[nodiscard]] Variant texts(const std::vector<std::string>& list);

/// The same of NodeIds.
[[nodiscard]] Variant node_ids(const std::vector<NodeId>& ids);

/// What the Property InputArguments or OutputArguments of a Method in namespace 0 says.
[[nodiscard]] Array<Argument> declared_arguments(const model::AddressSpace& space,
                                                 model::NodeIndex method,
                                                 std::string_view property);

/// The outputs of a Method that has one.
[[nodiscard]] inline Array<Variant> one_output(Variant value)
{
    Array<Variant> outputs;
    outputs.push_back(std::move(value));
    return outputs;
}

} // namespace busbar::administration::detail
