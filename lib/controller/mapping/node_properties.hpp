#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/controller/mapping.hpp>
#include <busbar/model/space_reader.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

namespace busbar::controller::detail {

/// Returns the Arguments in the property "InputArguments" or "OutputArguments" of a Method; empty
/// without the property. An entry of another type becomes an empty Argument.
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

/// Completes a scaling without a range by the Variable's EURange; nothing if there is neither.
[[nodiscard]] inline std::optional<Scaling>
scaling_of(const model::SpaceReader& space, model::NodeIndex variable, const Scaling& scaling)
{
    if (scaling.has_range()) {
        return scaling;
    }
    std::optional<Scaling> found;
    space.for_each_child(
        variable, space.find(id::HasProperty), true, QualifiedName{0, "EURange"},
        [&](model::NodeIndex node) {
            const Variant value = space.value(node);
            const auto* const object = value.get_if<ExtensionObject>();
            const auto range =
                object != nullptr ? binary::structure_of<Range>(*object) : std::nullopt;
            if (range && std::isfinite(range->high - range->low) && range->low != range->high) {
                found = {scaling.raw_low, scaling.raw_high, range->low, range->high};
            }
            return false;
        });
    return found;
}

} // namespace busbar::controller::detail
