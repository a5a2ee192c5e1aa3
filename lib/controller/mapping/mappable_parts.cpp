#include <busbar/controller/mappable_parts.hpp>

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include <busbar/controller/model_set.hpp>
#include <busbar/controller/value_shape.hpp>

#include "node_properties.hpp"
#include "table_fields.hpp"
#include "value_check.hpp"

namespace busbar::controller {

namespace {

/// Labels and array specifications of a value, by the paths of its parts.
struct MappedPaths {
    MappedPaths(const MappedPart* value, const std::string& prefix)
    {
        if (value != nullptr) {
            collect(*value, {}, prefix);
        }
    }

    void collect(const MappedPart& part, const std::string& path, const std::string& prefix)
    {
        if (!part.label.empty()) {
            labels.emplace_back(prefix + path, part.label);
        }
        if (part.specification.rank != ArraySpecification::none) {
            arrays.push_back({path, part.specification.rank, part.specification.dimensions});
        }
        for (const MappedPart& inner : part.parts) {
            collect(inner, part_path(path, inner), prefix);
        }
    }

    std::vector<std::pair<std::string, std::string>> labels;
    std::vector<MappingArray> arrays;
};

std::string type_text(LeafType type)
{
    return type.is_enumeration ? "Enumeration" : std::string{name(type.built_in)};
}

/// Collects the parts of one node.
class Lister {
public:
    Lister(const model::SpaceReader& space, const binary::DynamicTypes& types,
           const ModelLimits& limits)
        : space_{space}, types_{types}, limits_{limits.max_elements, limits.max_structure_levels,
                                                limits.max_elements}
    {
    }

    void add_value(const ValueDeclaration& declaration, const MappedPart* mapped,
                   const std::string& prefix, bool is_scaled = false)
    {
        const MappedPaths paths{mapped, prefix};
        std::unordered_map<std::string, std::string> labels{paths.labels.begin(),
                                                            paths.labels.end()};
        if (const auto shape = ValueShape::of(space_, types_, declaration, paths.arrays, limits_)) {
            for (std::size_t i = 0; i < shape->leaf_count(); ++i) {
                if (words_of(shape->leaf_type(i)) != 0) {
                    MappablePart part{prefix + shape->leaf_path(i),
                                      type_text(shape->leaf_type(i)),
                                      {},
                                      shape->leaf_type(i),
                                      is_scaled};
                    if (auto label = labels.extract(part.path)) {
                        part.label = std::move(label.mapped());
                    }
                    parts_.push_back(std::move(part));
                }
            }
        }
        for (const auto& [path, label] : paths.labels) {
            if (labels.contains(path)) {
                parts_.push_back({.path = path, .label = label});
            }
        }
    }
    void add(MappablePart part) { parts_.push_back(std::move(part)); }
    [[nodiscard]] std::vector<MappablePart> take() { return std::move(parts_); }

private:
    const model::SpaceReader& space_;
    const binary::DynamicTypes& types_;
    ShapeLimits limits_;
    std::vector<MappablePart> parts_;
};

const MappedPart* argument_of(const std::vector<MappedPart>& arguments, std::size_t number)
{
    const auto found =
        std::find_if(arguments.begin(), arguments.end(),
                     [&](const MappedPart& argument) { return argument.number == number; });
    return found != arguments.end() ? &*found : nullptr;
}

void add_arguments(Lister& lister, const std::vector<Argument>& arguments,
                   const std::vector<MappedPart>& mapped, std::string_view place)
{
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const Argument& each = arguments[i];
        lister.add_value({each.data_type, each.value_rank, each.array_dimensions.span(), true},
                         argument_of(mapped, i),
                         std::string{place} + '[' + std::to_string(i) + ']');
    }
}

void add_method(Lister& lister, const model::SpaceReader& space, model::NodeIndex node,
                const MethodMapping& mapped)
{
    const std::vector<Argument> outputs = detail::arguments_of(space, node, "OutputArguments");
    lister.add({std::string{detail::handle_part},
                std::string{name(BuiltInType::UInt16)},
                mapped.handle,
                {BuiltInType::UInt16}});
    if (!outputs.empty() || !mapped.done.empty()) {
        lister.add({std::string{detail::done_part},
                    std::string{name(BuiltInType::Boolean)},
                    mapped.done,
                    {BuiltInType::Boolean}});
    }
    add_arguments(lister, detail::arguments_of(space, node, "InputArguments"), mapped.arguments,
                  detail::input_part);
    add_arguments(lister, outputs, mapped.outputs, detail::output_part);
}

} // namespace

MappableParts::MappableParts(const ModelSet& models)
    : models_{models}, places_{models.space(), required_uris(models)}
{
}

std::string MappableParts::why_none(model::NodeIndex node)
{
    const model::SpaceReader& space = models_.space();
    const auto content = [](ModelCode code) { return std::string{rule_of(code).content}; };
    if (const NodePlace place = places_.of(node); place != NodePlace::Mappable) {
        return place == NodePlace::WrongNodeClass ? "It is neither a Variable nor a Method"
                                                  : content(detail::code_of(place));
    }
    if (space.node_class(node) == NodeClass::Method) {
        return {};
    }
    const model::VariableAttributes attributes = space.variable(node);
    const ModelLimits& limits = models_.limits();
    const auto shape = ValueShape::of(
        space, types_.of(space),
        {space.data_type_id(node), attributes.value_rank, attributes.array_dimensions, false}, {},
        {limits.max_elements, limits.max_structure_levels, limits.max_elements});
    if (!shape) {
        return content(ModelCode::NotAssignable) + ": " + shape.error().path + " " +
               shape.error().text;
    }
    for (std::size_t i = 0; i < shape->leaf_count(); ++i) {
        if (words_of(shape->leaf_type(i)) != 0) {
            return {};
        }
    }
    return content(ModelCode::NotAssignable);
}

std::vector<MappablePart> MappableParts::of(model::NodeIndex node)
{
    const model::SpaceReader& space = models_.space();
    if (places_.of(node) != NodePlace::Mappable) {
        return {};
    }
    Lister lister{space, types_.of(space), models_.limits()};
    const Mapping& mapping = models_.mapping();
    if (space.node_class(node) == NodeClass::Method) {
        const auto found = mapping.methods.find(space.node_id(node));
        add_method(lister, space, node,
                   found != mapping.methods.end() ? found->second : MethodMapping{});
        return lister.take();
    }
    const auto found = mapping.variables.find(space.node_id(node));
    const model::VariableAttributes attributes = space.variable(node);
    lister.add_value(
        {space.data_type_id(node), attributes.value_rank, attributes.array_dimensions, false},
        found != mapping.variables.end() ? &found->second.value : nullptr, {},
        found != mapping.variables.end() && found->second.scaling.is_set());
    if (found != mapping.variables.end() && !found->second.quality.empty()) {
        lister.add({std::string{detail::quality_part}, std::string{name(BuiltInType::StatusCode)},
                    found->second.quality});
    }
    return lister.take();
}

} // namespace busbar::controller
