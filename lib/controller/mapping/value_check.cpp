#include "value_check.hpp"

#include <algorithm>
#include <unordered_set>

#include <busbar/core/text.hpp>
#include <busbar/types/ids.hpp>

#include "core/ascii_case.hpp"

namespace busbar::controller::detail {

namespace {

void collect(const MappedPart& part, const std::string& path, std::vector<MappingArray>& to)
{
    if (part.specification.rank != ArraySpecification::none) {
        to.push_back({path, part.specification.rank, part.specification.dimensions});
    }
    for (const MappedPart& inner : part.parts) {
        collect(inner, part_path(path, inner), to);
    }
}

std::vector<MappingArray> arrays_of(const MappedPart& value)
{
    std::vector<MappingArray> arrays;
    collect(value, {}, arrays);
    return arrays;
}

ModelCode code_of(ShapeError error)
{
    switch (error) {
    case ShapeError::ArraySize:
    case ShapeError::TooManyLeaves:
        return ModelCode::TooManyElements;
    case ShapeError::Depth:
        return ModelCode::TooManyStructureLevels;
    default:
        return ModelCode::NotAssignable;
    }
}

/// Tells whether a mapping array specification may choose this rank for a ValueRank (SH-082679, 8.2
/// and 9.5).
bool allows_rank(std::int32_t value_rank, std::int32_t rank)
{
    constexpr std::int32_t scalar_or_one = -3;
    constexpr std::int32_t any = -2;
    switch (value_rank) {
    case scalar_or_one:
        return rank == -1 || rank == 1;
    case any:
        return true;
    case 0:
        return rank >= 1;
    default:
        return rank == value_rank;
    }
}

/// Tells whether the part is an array or a structure.
bool has_leaf_below(const ValueShape& shape, const std::string& path)
{
    for (std::size_t i = 0; i < shape.leaf_count(); ++i) {
        const std::string leaf = shape.leaf_path(i);
        if (leaf.size() > path.size() && leaf.starts_with(path) &&
            (leaf[path.size()] == '.' || leaf[path.size()] == '[')) {
            return true;
        }
    }
    return false;
}

std::string key_of(const MappedPart& part)
{
    if (part.kind != MappedPart::Kind::Field) {
        return std::to_string(part.number);
    }
    std::string key = ".";
    std::transform(part.name.begin(), part.name.end(), std::back_inserter(key),
                   busbar::detail::to_ascii_lower);
    return key;
}

using model::NodeIndex;

constexpr std::uint32_t unsupported_ids[] = {
    id::ConnectionTransportDataType,
    id::DataSetReaderDataType,
    id::DataSetReaderMessageDataType,
    id::DataSetWriterDataType,
    id::DataSetWriterMessageDataType,
    id::DataTypeSchemaHeader,
    id::FieldMetaData,
    id::PublishedDataSetDataType,
    id::PubSubConfigurationDataType,
    id::PubSubConnectionDataType,
    id::PubSubGroupDataType,
    id::RolePermissionType,
    id::SubscribedDataSetDataType,
    id::WriterGroupMessageDataType,
    id::ProgramDiagnosticType,
    id::DataSetReaderMessageType,
    id::DataSetReaderType,
    id::DataSetWriterMessageType,
    id::DataSetWriterType,
    id::PublishedDataSetType,
    id::WriterGroupMessageType,
};

} // namespace

void ValueCheck::check(const NodeId& node, const std::string& prefix,
                       const ValueDeclaration& declaration, const MappedPart& value)
{
    node_ = &node;
    prefix_ = &prefix;
    const auto arrays = arrays_of(value);
    check_specification(declaration, value);
    const auto shape = ValueShape::of(space_, types_, declaration, arrays, limits_);
    if (!shape) {
        report(code_of(shape.error().error), shape.error().path, shape.error().text);
        return;
    }
    check_part(value, {}, *shape);
}

std::size_t ValueCheck::words(const ValueDeclaration& declaration, const MappedPart* value) const
{
    const auto arrays = value == nullptr ? std::vector<MappingArray>{} : arrays_of(*value);
    const auto shape = ValueShape::of(space_, types_, declaration, arrays, limits_);
    return shape ? shape->words() : 0;
}

bool ValueCheck::is_numeric(const ValueDeclaration& declaration, const MappedPart& value) const
{
    const auto shape = ValueShape::of(space_, types_, declaration, arrays_of(value), limits_);
    if (!shape) {
        return true; // check() reports it
    }
    for (std::size_t i = 0; i < shape->leaf_count(); ++i) {
        const std::string path = shape->leaf_path(i);
        if (!is_scalable(shape->leaf_type(i)) || path.find('.') != std::string::npos) {
            return false;
        }
    }
    return true;
}

void ValueCheck::check_specification(const ValueDeclaration& declaration, const MappedPart& value)
{
    const ArraySpecification& specification = value.specification;
    if (specification.rank == ArraySpecification::none) {
        return;
    }
    const ArrayForm form = array_form(declaration.value_rank, declaration.array_dimensions, nullptr,
                                      declaration.is_argument, limits_);
    if (form.use != ArrayUse::Limited) {
        report(ModelCode::SpecificationUnused, {}, {});
    } else if (!allows_rank(declaration.value_rank, specification.rank)) {
        report(ModelCode::SpecificationInvalid, {},
               "rank " + std::to_string(specification.rank) + " for the ValueRank " +
                   std::to_string(declaration.value_rank));
    }
}

void ValueCheck::check_part(const MappedPart& part, const std::string& path,
                            const ValueShape& shape)
{
    check_siblings(part, path);
    if (part.kind == MappedPart::Kind::Field && part.specification.rank > 1) {
        report(ModelCode::SpecificationInvalid, path, "a field has one dimension at most");
    }
    if (!part.label.empty()) {
        check_label(part, path, shape);
    }
    for (const MappedPart& inner : part.parts) {
        check_part(inner, part_path(path, inner), shape);
    }
}

void ValueCheck::check_siblings(const MappedPart& part, const std::string& path)
{
    std::unordered_set<std::string> seen;
    for (const MappedPart& inner : part.parts) {
        if (!seen.insert(key_of(inner)).second) {
            report(ModelCode::PartRepeated, part_path(path, inner), {});
        }
    }
}

void ValueCheck::check_label(const MappedPart& part, const std::string& path,
                             const ValueShape& shape)
{
    if (const auto leaf = shape.find_leaf(path)) {
        const LeafType type = shape.leaf_type(*leaf);
        if (words_of(type) == 0) {
            report(ModelCode::NotAssignable, path,
                   "no label can have a value of type " + std::string{name(type.built_in)});
        }
        return;
    }
    const auto kept = shape.kept_fields();
    const auto why = std::find_if(kept.begin(), kept.end(), [&](const ShapeRefusal& refusal) {
        return path.starts_with(refusal.path);
    });
    if (why != kept.end()) {
        report(code_of(why->error), path, why->text);
    } else if (has_leaf_below(shape, path) || part.is_array || part.is_structure) {
        report(ModelCode::LabelNotHere, path, part.label);
    } else {
        report(ModelCode::PartUnknown, path, part.label);
    }
}

void ValueCheck::report(ModelCode code, const std::string& path, std::string_view found)
{
    const std::string place = *prefix_ + path;
    const std::string where = to_string(*node_) + (place.empty() ? place : ": " + place);
    reports_.add({code, *node_, printable(where, 512), printable(found)});
}

UnsupportedTypes::UnsupportedTypes(const model::SpaceReader& space) : space_{space}
{
    for (const std::uint32_t each : unsupported_ids) {
        if (const NodeIndex type = space.find(each); type != model::no_node) {
            types_.push_back(type);
        }
    }
    std::sort(types_.begin(), types_.end());
}

NodeIndex UnsupportedTypes::listed(NodeIndex type) const
{
    for (NodeIndex each = type; each != model::no_node; each = space_.supertype(each)) {
        if (std::binary_search(types_.begin(), types_.end(), each)) {
            return type;
        }
    }
    return model::no_node;
}

NodeIndex UnsupportedTypes::of(NodeIndex node) const
{
    const NodeClass node_class = space_.node_class(node);
    const bool is_variable = node_class == NodeClass::Variable;
    if (space_.node_id(node).namespace_index() == 0 ||
        !(is_variable || node_class == NodeClass::Object)) {
        return model::no_node;
    }
    const NodeIndex type = listed(space_.type_definition(node));
    if (type != model::no_node || !is_variable) {
        return type;
    }
    return listed(space_.find(space_.data_type_id(node)));
}

} // namespace busbar::controller::detail
