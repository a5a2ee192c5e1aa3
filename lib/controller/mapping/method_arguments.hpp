#pragma once

#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller::detail {

/// What the property "InputArguments" or "OutputArguments" of a Method says; empty without one. An
/// entry that is no Argument is an empty one.
[[nodiscard]] inline std::vector<Argument>
arguments_of(const model::SpaceReader& space, model::NodeIndex method, const char* property)
{
    std::vector<Argument> arguments;
    space.for_each_child(method, space.find(id::HasProperty), true, QualifiedName{0, property},
                         [&](model::NodeIndex node) {
                             const Variant value = space.value(node);
                             const auto* objects = value.array_if<ExtensionObject>();
                             for (std::size_t i = 0; objects != nullptr && i < objects->size();
                                  ++i) {
                                 const auto decoded = binary::structure_of<Argument>((*objects)[i]);
                                 arguments.push_back(decoded ? *decoded : Argument{});
                             }
                             return false;
                         });
    return arguments;
}

} // namespace busbar::controller::detail
