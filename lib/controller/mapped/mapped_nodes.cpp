#include <busbar/controller/mapped_nodes.hpp>

#include <utility>

#include <busbar/binary/codec.hpp>
#include <busbar/core/text_forms.hpp>
#include <busbar/types/data_types.hpp>
#include <busbar/types/ids.hpp>

#include "controller/conversion/shape_node.hpp"
#include "controller/mapping/node_properties.hpp"

namespace busbar::controller {

namespace {

/// Labels and array specifications of a part, by the paths of leaves in a ValueShape.
struct Paths {
    std::vector<std::pair<std::string, std::string>> labels;
    std::vector<MappingArray> arrays;

    void add(const MappedPart& part, const std::string& path)
    {
        if (!part.label.empty()) {
            labels.emplace_back(path, part.label);
        }
        if (part.specification.rank != ArraySpecification::none) {
            arrays.push_back({path, part.specification.rank, part.specification.dimensions});
        }
        for (const MappedPart& inner : part.parts) {
            const std::string step = inner.kind == MappedPart::Kind::Field
                                         ? detail::field_step(inner.name)
                                         : "[" + std::to_string(inner.number) + "]";
            add(inner, path + step);
        }
    }
};

class NodeMapper {
public:
    NodeMapper(model::AddressSpace& space, const binary::DynamicTypes& types, MappedSource& source,
               const ShapeLimits& limits)
        : space_{space}, types_{types}, source_{source}, limits_{limits}
    {
    }

    void add(const NodeId& id, const DataMapping& mapping)
    {
        Paths paths;
        paths.add(mapping.value, {});
        if (paths.labels.empty()) {
            return; // the address space keeps it
        }
        const model::NodeIndex node = find(id, NodeClass::Variable);
        if (node == model::no_node) {
            return;
        }
        const model::VariableAttributes attributes = space_.variable(node);
        MappedVariable mapped;
        mapped.node = id;
        mapped.initial = space_.value(node);
        mapped.is_readable = (attributes.access_level & 1U) != 0; // CurrentRead
        ValueDeclaration declaration;
        declaration.data_type = space_.node_id(attributes.data_type);
        declaration.value_rank = attributes.value_rank;
        declaration.array_dimensions = attributes.array_dimensions;
        mapped.shape = place(id, declaration, paths, mapped.labels);
        mapped.quality = mapping.quality;
        if (mapping.scaling.is_set()) {
            scale(node, mapping.scaling, mapped);
        }
        space_.bind(node, source_.index(), source_.add(std::move(mapped)));
        ++result_.variables;
    }
    void add(const NodeId& id, const MethodMapping& mapping)
    {
        const model::NodeIndex node = find(id, NodeClass::Method);
        if (node == model::no_node) {
            return;
        }
        MappedMethod mapped;
        mapped.node = id;
        mapped.handle = mapping.handle;
        mapped.done = mapping.done;
        add_arguments(id, detail::arguments_of(space_, node, "InputArguments"), mapping.arguments,
                      mapped.arguments);
        const auto outputs = detail::arguments_of(space_, node, "OutputArguments");
        mapped.has_outputs = !outputs.empty() && mapping.done.empty();
        if (!mapped.has_outputs) {
            add_outputs(id, outputs, mapping.outputs, mapped.outputs);
        }
        space_.bind(node, source_.index(), source_.add(std::move(mapped)));
        ++result_.methods;
    }
    [[nodiscard]] MappedNodes take() { return std::move(result_); }

private:
    [[nodiscard]] model::NodeIndex find(const NodeId& id, NodeClass wanted)
    {
        const model::NodeIndex node = space_.find(id);
        if (node == model::no_node || space_.node_class(node) != wanted) {
            leave_out(id, "there is no such node");
            return model::no_node;
        }
        return node;
    }
    /// Adds the scaling. If it needs an EURange that the Variable does not have, the node cannot be
    /// served.
    void scale(model::NodeIndex node, const Scaling& scaling, MappedVariable& mapped)
    {
        if (const auto whole = detail::scaling_of(space_, node, scaling)) {
            mapped.scaling = *whole;
        } else {
            leave_out(mapped.node, "it has no EURange to scale by");
            mapped.shape = nullptr;
        }
    }
    /// Adds arguments up to the last one that has labels.
    void add_arguments(const NodeId& id, const std::vector<Argument>& arguments,
                       const std::vector<MappedPart>& parts, std::vector<MappedArgument>& mapped)
    {
        for (const MappedPart& part : parts) {
            Paths paths;
            paths.add(part, {});
            if (part.number >= arguments.size()) {
                leave_out(id, "there is no argument " + std::to_string(part.number));
            } else if (!paths.labels.empty()) {
                if (mapped.size() <= part.number) {
                    mapped.resize(std::size_t{part.number} + 1);
                }
                add_argument(id, arguments[part.number], paths, mapped[part.number]);
            }
        }
    }
    /// Adds all outputs, since a client gets every one of them.
    void add_outputs(const NodeId& id, const std::vector<Argument>& arguments,
                     const std::vector<MappedPart>& parts, std::vector<MappedArgument>& mapped)
    {
        mapped.resize(arguments.size());
        add_arguments(id, arguments, parts, mapped);
        for (std::size_t i = 0; i < mapped.size(); ++i) {
            if (mapped[i].shape == nullptr && mapped[i].labels.empty()) {
                add_argument(id, arguments[i], {}, mapped[i]);
            }
        }
    }
    void add_argument(const NodeId& id, const Argument& argument, const Paths& paths,
                      MappedArgument& mapped)
    {
        ValueDeclaration declaration;
        declaration.data_type = argument.data_type;
        declaration.value_rank = argument.value_rank;
        declaration.array_dimensions = argument.array_dimensions.span();
        declaration.is_argument = true;
        mapped.shape = place(id, declaration, paths, mapped.labels);
    }
    /// Adds a value's labels. Null for an unsupported type; the order of its labels is then
    /// undefined.
    [[nodiscard]] std::shared_ptr<const ValueShape> place(const NodeId& id,
                                                          const ValueDeclaration& declaration,
                                                          const Paths& paths,
                                                          std::vector<std::string>& labels)
    {
        auto made = ValueShape::of(space_, types_, declaration, paths.arrays, limits_);
        if (!made) {
            if (!paths.labels.empty()) {
                labels.push_back(paths.labels.front().second);
            }
            return nullptr;
        }
        labels.resize(made->leaf_count());
        for (const auto& [path, label] : paths.labels) {
            if (const auto leaf = made->find_leaf(path)) {
                labels[*leaf] = label;
            } else {
                leave_out(id, "its value has no part \"" + path + "\"");
            }
        }
        return std::make_shared<const ValueShape>(std::move(*made));
    }
    void leave_out(const NodeId& id, const std::string& reason)
    {
        result_.left_out.push_back(to_string(id) + ": " + reason);
    }

    model::AddressSpace& space_;
    const binary::DynamicTypes& types_;
    MappedSource& source_;
    const ShapeLimits& limits_;
    MappedNodes result_;
};

} // namespace

namespace {

/// Tells whether a value is "not supported" rather than just not assigned (8.2).
bool is_unsupported(const ShapeRefusal& refusal, std::int32_t value_rank)
{
    switch (refusal.error) {
    case ShapeError::OptionSet:
    case ShapeError::Union:
    case ShapeError::OptionalFields:
    case ShapeError::SubtypedStructure:
    case ShapeError::EnumerationParent:
    case ShapeError::EnumerationMinusOne:
        return true;
    case ShapeError::ArrayRank:
        return value_rank > 3 || value_rank < -3;
    default:
        return false;
    }
}

} // namespace

std::size_t refuse_unsupported(model::AddressSpace& space, const binary::DynamicTypes& types,
                               MappedSource& source, const ShapeLimits& limits)
{
    std::vector<model::NodeIndex> unsupported;
    space.for_each([&](model::NodeIndex node) {
        if (space.node_class(node) != NodeClass::Variable ||
            space.node_id(node).namespace_index() <= 1) { // 0, and the server's own
            return;
        }
        const model::VariableAttributes variable = space.variable(node);
        if (variable.source != model::no_source) {
            return;
        }
        const auto shape = ValueShape::of(
            space, types,
            {space.data_type_id(node), variable.value_rank, variable.array_dimensions, false}, {},
            limits);
        if (!shape && is_unsupported(shape.error(), variable.value_rank)) {
            unsupported.push_back(node);
        }
    });
    for (const model::NodeIndex node : unsupported) {
        MappedVariable refused;
        refused.node = space.node_id(node);
        space.bind(node, source.index(), source.add(std::move(refused)));
    }
    return unsupported.size();
}

MappedNodes map_nodes(model::AddressSpace& space, const binary::DynamicTypes& types,
                      const Mapping& mapping, MappedSource& source, const ShapeLimits& limits)
{
    NodeMapper mapper{space, types, source, limits};
    for (const auto& [id, variable] : mapping.variables) {
        mapper.add(id, variable);
    }
    for (const auto& [id, method] : mapping.methods) {
        mapper.add(id, method);
    }
    return mapper.take();
}

} // namespace busbar::controller
