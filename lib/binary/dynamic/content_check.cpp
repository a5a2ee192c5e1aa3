#include "body_walk.hpp"

#include <algorithm>

#include "matrix_header.hpp"

namespace busbar::binary::detail {

namespace {

/// Returns the product of the dimensions, more than INT32_MAX if it exceeds that.
std::size_t element_count(std::span<const std::uint32_t> dimensions)
{
    std::size_t product = 1;
    for (const std::uint32_t dimension : dimensions) {
        product = times_dimension(product, dimension, INT32_MAX);
    }
    return product;
}

/// True if `count` elements with these dimensions are a matrix of the field's rank. A matrix
/// without elements may have no dimensions.
bool fits_matrix(const DynamicField& field, std::span<const std::uint32_t> dimensions,
                 std::size_t count)
{
    if (dimensions.empty()) {
        return count == 0;
    }
    const bool is_encodable =
        std::all_of(dimensions.begin(), dimensions.end(),
                    [](std::uint32_t dimension) { return dimension <= INT32_MAX; });
    return is_encodable && dimensions.size() == static_cast<std::size_t>(field.value_rank) &&
           element_count(dimensions) == count;
}

bool fits_shape(const DynamicField& field, std::span<const std::uint32_t> dimensions,
                std::size_t count)
{
    return field.is_matrix() ? fits_matrix(field, dimensions, count) : dimensions.empty();
}

bool fit_variants(const DynamicField& field, const Array<Variant>& elements)
{
    return std::all_of(elements.begin(), elements.end(),
                       [&](const Variant& element) { return fits_variant(field, element); });
}

} // namespace

bool fits_variant(const DynamicField& field, const Variant& content)
{
    return content.is_null() ||
           ((field.variant_types >> static_cast<unsigned>(content.type())) & 1U) != 0;
}

bool fits(const DynamicField& field, const Variant& content)
{
    if (field.is_structure) {
        return false;
    }
    if (field.is_scalar()) {
        return field.built_in == BuiltInType::Variant
                   ? fits_variant(field, content)
                   : content.is_scalar() && content.type() == field.built_in;
    }
    if (content.type() != field.built_in || !content.is_array() ||
        !fits_shape(field, content.dimensions(), content.array_size())) {
        return false;
    }
    const auto* const variants = content.array_if<Variant>();
    return variants == nullptr || fit_variants(field, *variants);
}

bool fits(const DynamicField& field, const DynamicValue& content)
{
    return field.is_structure && field.is_scalar() && &content.type() == field.type;
}

bool fits(const DynamicField& field, const DynamicArray& content)
{
    if (!field.is_structure || field.is_scalar()) {
        return false;
    }
    return fits_shape(field, content.dimensions.span(), content.values.size()) &&
           std::all_of(content.values.begin(), content.values.end(),
                       [&](const DynamicValue& value) { return &value.type() == field.type; });
}

bool may_be_subtype(const DynamicField& field, const DynamicValue& content)
{
    return !field.is_structure && field.is_scalar() &&
           field.built_in == BuiltInType::ExtensionObject &&
           (field.type == nullptr || content.type().is_subtype_of(*field.type));
}

} // namespace busbar::binary::detail
