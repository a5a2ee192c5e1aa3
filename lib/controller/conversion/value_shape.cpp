#include <busbar/controller/value_shape.hpp>

#include <algorithm>
#include <charconv>

#include "controller/conversion/shape_builder.hpp"
#include "controller/conversion/shape_node.hpp"

namespace busbar::controller {

namespace {

using detail::ShapeNode;

/// The place of a leaf: its node and the index of the element in it.
struct Place {
    const ShapeNode* node;
    std::size_t element;
};

/// Descends to a leaf; writes its path to `path` unless that is null.
Place place_of(const ShapeNode& root, std::size_t leaf, std::string* path)
{
    const ShapeNode* node = &root;
    while (node->kind == ShapeNode::Kind::Structure) {
        std::size_t element = 0;
        while (leaf >= detail::leaves_of(node->fields_of(element))) {
            const std::size_t leaves = detail::leaves_of(node->fields_of(element));
            // Skip all elements that are alike at once.
            const std::size_t passed = node->contents.size() == 1 ? leaf / leaves : 1;
            element += passed;
            leaf -= passed * leaves;
        }
        const ShapeNode::Fields& fields = node->fields_of(element);
        std::size_t field = 0;
        for (; leaf >= fields[field].leaves; ++field) {
            leaf -= fields[field].leaves;
        }
        if (path != nullptr) {
            *path += detail::element_path(node->form, element) +
                     detail::field_step(node->type->fields[field].name);
        }
        node = &fields[field];
    }
    if (path != nullptr) {
        *path += detail::element_path(node->form, leaf);
    }
    return {node, leaf};
}

/// Takes "[1][2]", one index for each dimension, from the front of `path`.
std::optional<std::size_t> take_element(const ArrayForm& form, std::string_view& path)
{
    std::size_t element = 0;
    for (std::size_t i = 0; i < form.rank; ++i) {
        std::uint32_t index = 0;
        if (!path.starts_with('[')) {
            return std::nullopt;
        }
        const char* const end = path.data() + path.size();
        const auto [rest, error] = std::from_chars(path.data() + 1, end, index);
        if (error != std::errc{} || rest == end || *rest != ']' || index >= form.dimensions[i]) {
            return std::nullopt;
        }
        path.remove_prefix(static_cast<std::size_t>(rest + 1 - path.data()));
        element = element * form.dimensions[i] + index;
    }
    return element;
}

std::optional<std::size_t> find(const ShapeNode& node, std::string_view path)
{
    const auto element = take_element(node.form, path);
    if (!element || node.kind == ShapeNode::Kind::Kept) {
        return std::nullopt;
    }
    if (node.kind == ShapeNode::Kind::Leaf) {
        return path.empty() ? element : std::nullopt;
    }
    std::size_t before = 0;
    for (std::size_t i = 0; i < (node.contents.size() == 1 ? 0 : *element); ++i) {
        before += detail::leaves_of(node.contents[i]);
    }
    const ShapeNode::Fields& fields = node.fields_of(*element);
    before += node.contents.size() == 1 ? *element * detail::leaves_of(fields) : 0;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string name = detail::field_step(node.type->fields[i].name);
        if (path.starts_with(name)) {
            if (const auto found = find(fields[i], path.substr(name.size()))) {
                return before + *found;
            }
        }
        before += fields[i].leaves;
    }
    return std::nullopt;
}

std::size_t words(const ShapeNode& node)
{
    if (node.kind == ShapeNode::Kind::Kept || node.form.is_open) {
        return 0;
    }
    if (node.kind == ShapeNode::Kind::Leaf) {
        return words_of(node.leaf) * node.leaves;
    }
    std::size_t sum = 0;
    for (const ShapeNode::Fields& fields : node.contents) {
        for (const ShapeNode& field : fields) {
            sum += words(field);
        }
    }
    return node.contents.size() == 1 ? sum * node.form.elements() : sum;
}

} // namespace

namespace detail {

std::string element_path(const ArrayForm& form, std::size_t element)
{
    std::string path;
    for (std::size_t i = form.rank; i > 0; --i) {
        const std::uint32_t dimension = form.dimensions[i - 1];
        std::string index{"["};
        index += std::to_string(element % dimension);
        index += ']';
        path.insert(0, index);
        element /= dimension;
    }
    return path;
}

} // namespace detail

ValueShape::ValueShape(std::unique_ptr<detail::ShapeNode> root, const binary::DynamicTypes& types,
                       std::vector<ShapeRefusal> kept)
    : root_{std::move(root)}, types_{&types}, kept_{std::move(kept)}
{
}
ValueShape::ValueShape(ValueShape&&) noexcept = default;
ValueShape& ValueShape::operator=(ValueShape&&) noexcept = default;
ValueShape::~ValueShape() = default;

Expected<ValueShape, ShapeRefusal> ValueShape::of(const model::SpaceReader& space,
                                                  const binary::DynamicTypes& types,
                                                  const ValueDeclaration& declaration,
                                                  std::span<const MappingArray> arrays,
                                                  const ShapeLimits& limits)
{
    detail::ShapeBuilder builder{space, types, arrays, limits};
    auto root = builder.build(declaration);
    if (!root) {
        return Unexpected<ShapeRefusal>{std::move(root.error())};
    }
    return ValueShape{std::make_unique<ShapeNode>(*std::move(root)), types, builder.take_kept()};
}

std::size_t ValueShape::leaf_count() const
{
    return root_->leaves;
}

LeafType ValueShape::leaf_type(std::size_t leaf) const
{
    return place_of(*root_, leaf, nullptr).node->leaf;
}

std::string ValueShape::leaf_path(std::size_t leaf) const
{
    std::string path;
    place_of(*root_, leaf, &path);
    return path;
}

std::optional<std::size_t> ValueShape::find_leaf(std::string_view path) const
{
    return find(*root_, path);
}

std::size_t ValueShape::rank() const
{
    return root_->form.rank;
}

std::span<const std::uint32_t> ValueShape::dimensions() const
{
    return root_->dimensions();
}

Result<Variant> ValueShape::assemble(const Variant* previous, Fill fill) const
{
    return detail::assemble(*root_, *types_, previous, fill);
}

StatusCode ValueShape::take_apart(const Variant& value, Take take) const
{
    return detail::take_apart(*root_, *types_, value, take);
}

std::size_t ValueShape::words() const
{
    return controller::words(*root_);
}

std::size_t ValueShape::monitored_bytes() const
{
    return monitored_bytes_of(root_->leaf.built_in) * root_->form.elements();
}

} // namespace busbar::controller
