#include "node_text.hpp"

namespace busbar::tool::project {

std::string rank_text(std::int32_t rank)
{
    switch (rank) {
    case -3:
        return "-3 (ScalarOrOneDimension)";
    case -2:
        return "-2 (Any)";
    case -1:
        return "-1 (Scalar)";
    case 0:
        return "0 (OneOrMoreDimensions)";
    default:
        return std::to_string(rank);
    }
}

std::string dimensions_text(std::span<const std::uint32_t> dimensions)
{
    std::string text;
    for (const std::uint32_t dimension : dimensions) {
        text += (text.empty() ? "" : ",") + std::to_string(dimension);
    }
    return text;
}

std::string plain_name(const model::SpaceReader& space, const NodeId& id)
{
    const model::NodeIndex node = space.find(id);
    return node != model::no_node ? std::string{space.browse_name(node).name.view()}
                                  : to_string(id);
}

Variant property_of(const model::SpaceReader& space, model::NodeIndex node, const char* name)
{
    Variant value;
    space.for_each_child(node, space.find(id::HasProperty), true, QualifiedName{0, name},
                         [&](model::NodeIndex found) {
                             value = space.value(found);
                             return false;
                         });
    return value;
}

std::vector<NamedArgument> arguments_of(const model::SpaceReader& space, model::NodeIndex method)
{
    std::vector<NamedArgument> arguments;
    if (space.node_class(method) != NodeClass::Method) {
        return arguments;
    }
    for (const std::string kind : {"Input", "Output"}) {
        const Variant value = property_of(space, method, (kind + "Arguments").c_str());
        const auto* const objects = value.array_if<ExtensionObject>();
        for (std::size_t i = 0; objects != nullptr && i < objects->size(); ++i) {
            if (const auto argument = binary::structure_of<Argument>((*objects)[i])) {
                arguments.push_back({kind + "[" + std::to_string(i) + "]", *argument});
            }
        }
    }
    return arguments;
}

} // namespace busbar::tool::project
