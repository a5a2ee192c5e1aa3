#include "mender.hpp"

#include <algorithm>
#include <array>

#include <busbar/model/nodeset.hpp>

#include "data_types.hpp"
#include "node_flags.hpp"

namespace busbar::nodeset {

namespace {

using model::NodeSetRule;

/// The type at the root of each hierarchy (Part 5, 6.2, 7.2, 12.2 and 11.1).
NodeId base_type(const Node& node)
{
    constexpr std::uint32_t base_object_type = 58;
    constexpr std::uint32_t base_variable_type = 62;
    constexpr std::uint32_t references = 31;
    switch (node.node_class) {
    case NodeClass::ObjectType:
        return NodeId{0, base_object_type};
    case NodeClass::VariableType:
        return NodeId{0, base_variable_type};
    case NodeClass::ReferenceType:
        return NodeId{0, references};
    default:
        break;
    }
    if (!node.definition || node.definition->fields.empty()) {
        return NodeId{0, static_cast<std::uint32_t>(BuiltInType::Variant)};
    }
    if (node.definition->is_union) {
        return NodeId{0, basic_id::Union};
    }
    const auto& fields = node.definition->fields;
    const bool has_numbers = std::any_of(fields.begin(), fields.end(),
                                         [](const Field& field) { return field.value >= 0; });
    if (node.definition->is_option_set) {
        return NodeId{0, static_cast<std::uint32_t>(BuiltInType::UInt32)};
    }
    return NodeId{0, has_numbers ? basic_id::Enumeration : basic_id::Structure};
}

} // namespace

Mender::Mender(Document& document, const LoadPlan& plan)
    : document_{document}, plan_{plan}, supertypes_(document.nodes().size()),
      type_definitions_(document.nodes().size())
{
}

bool Mender::is_mended(const Node& node) const
{
    return document_.is_lenient(node) && !plan_.is_skipped(node);
}

void Mender::mend()
{
    for (Node& node : document_.nodes_) {
        if (is_mended(node)) {
            drop_references(node);
        }
    }
    find_types();
    for (Node& node : document_.nodes_) {
        if (!is_mended(node)) {
            continue;
        }
        if (is_type(node)) {
            add_supertype(node);
        } else if (is_instance(node.node_class)) {
            add_type_definition(node);
        }
        if (node.node_class == NodeClass::Variable || node.node_class == NodeClass::VariableType) {
            check_data_type(node);
        }
    }
}

void Mender::drop_references(Node& node)
{
    auto& references = node.references;
    const auto end =
        std::remove_if(references.begin(), references.end(), [&](const Reference& reference) {
            const std::string why = fault(node, reference);
            if (!why.empty()) {
                repair(NodeSetRule::DanglingReference, node,
                       "left out a reference " +
                           std::string{reference.is_forward ? "to " : "from "} +
                           plan_.text(reference.target) + why,
                       reference.line);
            }
            return !why.empty();
        });
    references.erase(end, references.end());
}

std::string Mender::fault(const Node& node, const Reference& reference) const
{
    const Target type = plan_.find(reference.type);
    if (!type.exists() || plan_.class_of(type) != NodeClass::ReferenceType) {
        return ", whose ReferenceType " + plan_.text(reference.type) + " is nowhere";
    }
    const Target other = plan_.find(reference.target);
    if (!other.exists()) {
        return ", which is nowhere";
    }
    const NodeClass source = reference.is_forward ? node.node_class : plan_.class_of(other);
    const NodeClass target = reference.is_forward ? plan_.class_of(other) : node.node_class;
    if (reference.type.is(has_subtype) && (source != target || !model::detail::is_type(source))) {
        return ", a HasSubtype reference between " + std::string{name(source)} + " and " +
               std::string{name(target)};
    }
    const NodeClass expected =
        source == NodeClass::Object ? NodeClass::ObjectType : NodeClass::VariableType;
    if (reference.type.is(has_type_definition) && (!is_instance(source) || target != expected)) {
        return ", a HasTypeDefinition reference from " + std::string{name(source)} + " to " +
               std::string{name(target)};
    }
    return {};
}

/// Finds the supertypes and type definitions that the files give, from either side.
void Mender::find_types()
{
    for (Node& node : document_.nodes_) {
        auto& references = node.references;
        const auto end =
            std::remove_if(references.begin(), references.end(), [&](const Reference& reference) {
                if (note_type(node, reference)) {
                    return false;
                }
                repair(NodeSetRule::SecondType, node,
                       "left out the second " +
                           std::string{reference.type.is(has_subtype) ? "HasSubtype"
                                                                      : "HasTypeDefinition"} +
                           " reference to or from " + plan_.text(reference.target),
                       reference.line);
                return true;
            });
        references.erase(end, references.end());
    }
}

bool Mender::note_type(const Node& node, const Reference& reference)
{
    const bool is_subtype = reference.type.is(has_subtype);
    if (!is_subtype && !reference.type.is(has_type_definition)) {
        return true;
    }
    // The node that has one type: the target of HasSubtype, the source of HasTypeDefinition.
    const bool is_other = reference.is_forward == is_subtype;
    const NodeId& owner_id = is_other ? reference.target : node.id;
    const NodeId& type = is_other ? node.id : reference.target;
    const Node* const owner = plan_.find(owner_id).node;
    if (owner == nullptr) {
        // A type of the address space has its supertype there.
        const bool is_second = is_subtype && is_mended(node) && plan_.find(type).node != nullptr &&
                               plan_.find(owner_id).exists();
        return !is_second;
    }
    const auto position = static_cast<std::size_t>(owner - document_.nodes_.data());
    NodeId& known = (is_subtype ? supertypes_ : type_definitions_)[position];
    if (!known.is_null() && known != type) {
        return !is_mended(node);
    }
    known = type;
    return true;
}

void Mender::add_supertype(Node& node)
{
    if (!supertypes_[static_cast<std::size_t>(&node - document_.nodes_.data())].is_null()) {
        return;
    }
    const Target parent = plan_.find(node.parent);
    const bool has_parent = !node.parent.is_null() && parent.exists() && parent.node != &node &&
                            plan_.class_of(parent) == node.node_class;
    const NodeId above = has_parent ? node.parent : base_type(node);
    node.references.push_back({NodeId{0, has_subtype}, above, false, node.line});
    repair(NodeSetRule::Supertype, node,
           "took " + plan_.text(above) + " for the supertype, which is missing");
}

void Mender::add_type_definition(Node& node)
{
    if (!type_definitions_[static_cast<std::size_t>(&node - document_.nodes_.data())].is_null()) {
        return;
    }
    constexpr std::uint32_t base_object_type = 58;
    constexpr std::uint32_t base_data_variable_type = 63;
    constexpr std::uint32_t property_type = 68;
    constexpr std::uint32_t has_property = 46;
    const bool is_property =
        std::any_of(node.references.begin(), node.references.end(), [](const Reference& reference) {
            return !reference.is_forward && reference.type.is(has_property);
        });
    std::string_view name = "BaseDataVariableType";
    NodeId type{0, base_data_variable_type};
    if (node.node_class == NodeClass::Object) {
        name = "BaseObjectType";
        type = NodeId{0, base_object_type};
    } else if (is_property) {
        name = "PropertyType"; // Part 3, 5.6.3
        type = NodeId{0, property_type};
    }
    node.references.push_back({NodeId{0, has_type_definition}, std::move(type), true, node.line});
    repair(NodeSetRule::TypeDefinition, node,
           "took " + std::string{name} + " for the type definition, which is missing");
}

void Mender::check_data_type(Node& node)
{
    const Target type = plan_.find(node.data_type);
    if (type.exists() && plan_.class_of(type) == NodeClass::DataType) {
        return;
    }
    repair(NodeSetRule::DataType, node,
           "took BaseDataType for the DataType " + plan_.text(node.data_type) +
               ", which is nowhere");
    node.data_type = NodeId{0, static_cast<std::uint32_t>(BuiltInType::Variant)};
}

} // namespace busbar::nodeset

namespace busbar::model {

namespace {

struct RuleTexts {
    std::string_view name;
    std::string_view effect;
};

constexpr std::array<RuleTexts, nodeset_rule_count> rule_texts{{
    {"dangling-reference", "references that lead nowhere were left out"},
    {"type-definition", "the missing type definitions are base types"},
    {"supertype", "the missing supertypes are ParentNodeIds or base types"},
    {"second-type", "further supertypes and type definitions were left out"},
    {"alias", "names without <Alias> are those of types of OPC UA"},
    {"older-model", "required models are of older versions"},
    {"data-type", "DataTypes of Variables that are nowhere are BaseDataType"},
    {"value-converted", "values were converted to what their Variables may have"},
    {"value-removed", "values that their Variables cannot have were left out"},
    {"array-dimensions", "ArrayDimensions that values exceed are 0"},
}};

const RuleTexts& texts_of(NodeSetRule rule)
{
    return rule_texts[static_cast<std::size_t>(rule)];
}

} // namespace

std::string_view name(NodeSetRule rule)
{
    return texts_of(rule).name;
}

std::string_view effect(NodeSetRule rule)
{
    return texts_of(rule).effect;
}

std::string text(const NodeSetRepair& repair)
{
    return busbar::text(repair.done) + " (rule " + std::string{name(repair.rule)} + ")";
}

std::vector<std::string> counted_repairs(const NodeSetSummary& summary)
{
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < nodeset_rule_count; ++i) {
        const std::size_t count = summary.repair_counts[i];
        if (count != 0) {
            lines.push_back(std::to_string(count) + (count == 1 ? " time " : " times ") +
                            std::string{rule_texts[i].name} + ": " +
                            std::string{rule_texts[i].effect});
        }
    }
    return lines;
}

} // namespace busbar::model
