#include "controller/conversion/shape_builder.hpp"

#include <algorithm>

#include <busbar/core/text.hpp>

#include "shape_node.hpp"

namespace busbar::controller::detail {

namespace {

Unexpected<ShapeRefusal> refuse(ShapeError error, std::string path, std::string text)
{
    return Unexpected<ShapeRefusal>{ShapeRefusal{error, std::move(path), std::move(text)}};
}

/// Tells whether a field that cannot be mapped makes the whole value unusable (8.2, "Restrictions"
/// and 8.1, Call); otherwise the field keeps its value and the others can be mapped.
bool spoils_all(ShapeError error)
{
    switch (error) {
    case ShapeError::Union:
    case ShapeError::OptionalFields:
    case ShapeError::SubtypedStructure:
    case ShapeError::FieldRank:
    case ShapeError::TooManyLeaves:
        return true;
    default:
        return false;
    }
}

/// Multiplies up to `limit`; false if the product exceeds it.
bool multiply(std::size_t factor, std::size_t limit, std::size_t& leaves)
{
    if (factor != 0 && leaves > limit / factor) {
        return false;
    }
    leaves *= factor;
    return true;
}

} // namespace

ShapeBuilder::ShapeBuilder(const model::SpaceReader& space, const binary::DynamicTypes& types,
                           std::span<const MappingArray> arrays, const ShapeLimits& limits)
    : space_{space}, types_{types}, limits_{limits}
{
    for (const MappingArray& array : arrays) {
        arrays_.push_back(&array);
    }
    std::sort(arrays_.begin(), arrays_.end(),
              [](const auto* a, const auto* b) { return a->path < b->path; });
}

Expected<ShapeNode, ShapeRefusal> ShapeBuilder::build(const ValueDeclaration& declaration)
{
    is_argument_ = declaration.is_argument;
    return value(declaration, {}, 1);
}

const MappingArray* ShapeBuilder::chosen(std::string_view path) const
{
    const auto found =
        std::lower_bound(arrays_.begin(), arrays_.end(), path,
                         [](const auto* array, std::string_view p) { return array->path < p; });
    return found != arrays_.end() && (*found)->path == path ? *found : nullptr;
}

bool ShapeBuilder::has_choices_in(std::string_view array_path) const
{
    const std::string prefix = std::string{array_path} + "[";
    const auto found =
        std::lower_bound(arrays_.begin(), arrays_.end(), prefix,
                         [](const auto* array, const std::string& p) { return array->path < p; });
    return found != arrays_.end() && (*found)->path.starts_with(prefix);
}

ShapeBuilder::Node ShapeBuilder::value(const ValueDeclaration& declaration, const std::string& path,
                                       std::size_t depth)
{
    if (++nodes_ > limits_.max_leaves) {
        return refuse(ShapeError::TooManyLeaves, path, "there are too many fields");
    }
    auto use = use_of(space_, types_, declaration.data_type);
    if (!use) {
        use.error().path = path;
        return Unexpected<ShapeRefusal>{std::move(use.error())};
    }
    ShapeNode node;
    node.leaf = use->leaf;
    node.type = use->structure;
    node.form = array_form(declaration.value_rank, declaration.array_dimensions, chosen(path),
                           is_argument_, limits_);
    if (node.form.is_too_large) {
        return refuse(ShapeError::ArraySize, path, "the array has too many elements");
    }
    if (node.form.use == ArrayUse::No) {
        return refuse(ShapeError::ArrayRank, path, "ValueRank and ArrayDimensions cannot be used");
    }
    if (node.type != nullptr) {
        return structure(std::move(node), path, depth);
    }
    node.leaves = node.form.elements();
    if (node.leaves > limits_.max_leaves) {
        return refuse(ShapeError::TooManyLeaves, path, "there are too many elements");
    }
    return node;
}

ShapeBuilder::Node ShapeBuilder::structure(ShapeNode node, const std::string& path,
                                           std::size_t depth)
{
    if (depth > limits_.max_structure_depth) {
        return refuse(ShapeError::Depth, path, "too many structures are within one another");
    }
    node.kind = ShapeNode::Kind::Structure;
    const bool is_array = node.form.rank > 0;
    const std::size_t different = is_array && has_choices_in(path) ? node.form.elements() : 1;
    for (std::size_t i = 0; i < different; ++i) {
        auto made = fields(*node.type, path + element_path(node.form, i), depth);
        if (!made) {
            return Unexpected<ShapeRefusal>{std::move(made.error())};
        }
        node.leaves += leaves_of(*made);
        node.contents.push_back(*std::move(made));
    }
    const std::size_t alike = different == 1 ? node.form.elements() : 1;
    if (!multiply(alike, limits_.max_leaves, node.leaves) || node.leaves > limits_.max_leaves) {
        return refuse(ShapeError::TooManyLeaves, path, "there are too many fields and elements");
    }
    return node;
}

ShapeBuilder::Fields ShapeBuilder::fields(const binary::DynamicType& type, const std::string& path,
                                          std::size_t depth)
{
    ShapeNode::Fields made;
    made.reserve(type.fields.size());
    for (const binary::DynamicField& each : type.fields) {
        const std::string field_path = path + field_step(each.name);
        Node node = field(each, field_path, depth);
        if (!node && spoils_all(node.error().error)) {
            return Unexpected<ShapeRefusal>{std::move(node.error())};
        }
        if (!node) {
            kept_.push_back(std::move(node.error()));
            ShapeNode kept;
            kept.kind = ShapeNode::Kind::Kept;
            made.push_back(std::move(kept));
            continue;
        }
        made.push_back(*std::move(node));
    }
    return made;
}

ShapeBuilder::Node ShapeBuilder::field(const binary::DynamicField& field, const std::string& path,
                                       std::size_t depth)
{
    if (field.value_rank != -1 && field.value_rank != 1) {
        return refuse(ShapeError::FieldRank, path, "a field's ValueRank is neither -1 nor 1");
    }
    if (field.allows_subtypes) {
        return refuse(ShapeError::AbstractType, path, "the field may hold subtypes");
    }
    const ValueDeclaration declaration{field.data_type, field.value_rank, field.array_dimensions,
                                       is_argument_};
    return value(declaration, path, depth + 1);
}

} // namespace busbar::controller::detail
