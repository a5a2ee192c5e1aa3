#include <busbar/model/space_reader.hpp>

#include "tables.hpp"

namespace busbar::model {

using detail::Extra;
using detail::number;
using detail::Tables;

namespace {

constexpr std::uint8_t number_type = 26;
constexpr std::uint8_t integer_type = 27;
constexpr std::uint8_t unsigned_type = 28;

constexpr std::uint32_t bit(BuiltInType type)
{
    return std::uint32_t{1} << static_cast<unsigned>(type);
}

constexpr std::uint32_t signed_bits = bit(BuiltInType::SByte) | bit(BuiltInType::Int16) |
                                      bit(BuiltInType::Int32) | bit(BuiltInType::Int64);
constexpr std::uint32_t unsigned_bits = bit(BuiltInType::Byte) | bit(BuiltInType::UInt16) |
                                        bit(BuiltInType::UInt32) | bit(BuiltInType::UInt64);
/// Decimal, a Number, is encoded as a structure (Part 6, 5.1.10).
constexpr std::uint32_t number_bits = signed_bits | unsigned_bits | bit(BuiltInType::Float) |
                                      bit(BuiltInType::Double) | bit(BuiltInType::ExtensionObject);

/// Returns StaticType::built_in of the DataType, 0 for other nodes.
std::uint8_t static_built_in(const Tables& tables, NodeIndex data_type)
{
    if (data_type == no_node) {
        return 0;
    }
    NodeIndex base = data_type;
    if (!tables.is_constant(base)) {
        const Extra* const extra = tables.record(base).extra.get();
        base = extra == nullptr ? no_node : extra->constant_base;
    }
    return number(base) < tables.constants->types.size()
               ? tables.constants->types[number(base)].built_in
               : std::uint8_t{0};
}

std::int32_t dimension_count(const Variant& value)
{
    if (value.is_matrix()) {
        return static_cast<std::int32_t>(value.dimensions().size());
    }
    return value.is_array() ? 1 : 0;
}

bool fits_rank(std::int32_t dimensions, std::int32_t rank)
{
    switch (rank) {
    case -3: // ScalarOrOneDimension
        return dimensions <= 1;
    case -2: // Any
        return true;
    case -1: // Scalar
        return dimensions == 0;
    case 0: // OneOrMoreDimensions
        return dimensions >= 1;
    default:
        return dimensions == rank;
    }
}

/// Checks that each dimension is at most as long as the attribute allows; 0 means no limit (Part 3,
/// 5.6.2).
bool fits_dimensions(const Variant& value, std::span<const std::uint32_t> limits)
{
    if (!value.is_array() || limits.empty()) {
        return true;
    }
    if (!value.is_matrix()) {
        return limits.size() == 1 && (limits[0] == 0 || value.array_size() <= limits[0]);
    }
    const auto dimensions = value.dimensions();
    if (dimensions.size() != limits.size()) {
        return false;
    }
    for (std::size_t i = 0; i < limits.size(); ++i) {
        if (limits[i] != 0 && dimensions[i] > limits[i]) {
            return false;
        }
    }
    return true;
}

/// Returns the DataType whose encoding is `encoding`.
NodeIndex described_by(const SpaceReader& space, NodeIndex encoding)
{
    const NodeIndex has_encoding = space.find(detail::id_has_encoding);
    ReferenceCursor cursor = space.references(encoding);
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward && reference->type == has_encoding) {
            return reference->target;
        }
    }
    return no_node;
}

NodeIndex structure_type(const SpaceReader& space, const ExtensionObject& object)
{
    const NodeIndex encoding = space.find(object.encoding_id());
    NodeIndex type = encoding == no_node ? no_node : described_by(space, encoding);
    if (type == no_node && object.type() != nullptr) {
        // A small namespace 0 has no encoding nodes.
        type = space.find(object.type()->type_id.in(object.encoding_id().namespace_index()));
    }
    return type;
}

bool fits_structure(const SpaceReader& space, const ExtensionObject& object, NodeIndex data_type)
{
    return object.is_null() || space.node_id(data_type).is(detail::id_structure) ||
           space.is_subtype_of(structure_type(space, object), data_type);
}

bool fit_structures(const SpaceReader& space, const Variant& value, NodeIndex data_type)
{
    if (const auto* const object = value.get_if<ExtensionObject>()) {
        return fits_structure(space, *object, data_type);
    }
    if (const auto* const objects = value.array_if<ExtensionObject>()) {
        for (const ExtensionObject& object : *objects) {
            if (!fits_structure(space, object, data_type)) {
                return false;
            }
        }
    }
    return true;
}

} // namespace

NodeIndex SpaceReader::supertype(NodeIndex type) const
{
    if (!tables_->is_constant(type)) {
        const detail::NodeLinks& links = tables_->links(type);
        return links.parent_reference == tables_->has_subtype ? links.parent : no_node;
    }
    ReferenceCursor cursor = references(type);
    while (const auto reference = cursor.next()) {
        if (!reference->is_forward && reference->type == tables_->has_subtype) {
            return reference->target;
        }
    }
    return no_node;
}

bool SpaceReader::is_subtype_of(NodeIndex type, NodeIndex supertype) const
{
    if (type == no_node || supertype == no_node) {
        return false;
    }
    const auto types = tables_->constants->types;
    NodeIndex base = type;
    const Extra* const extra =
        tables_->is_constant(type) ? nullptr : tables_->record(type).extra.get();
    if (!tables_->is_constant(type)) {
        base = extra == nullptr ? no_node : extra->constant_base;
    }
    if (tables_->is_constant(supertype)) {
        return number(supertype) < types.size() && number(base) >= number(supertype) &&
               number(base) <= types[number(supertype)].last;
    }
    const Extra* const above = tables_->record(supertype).extra.get();
    if (extra == nullptr || above == nullptr || above->chain.empty()) {
        return false;
    }
    const std::size_t depth = above->chain.size() - 1;
    return extra->chain.size() > depth && extra->chain[depth] == supertype;
}

bool SpaceReader::is_subtype_of(NodeIndex type, std::uint32_t supertype) const
{
    return is_subtype_of(type, tables_->find_constant(supertype));
}

BuiltInType SpaceReader::built_in_type_of(NodeIndex data_type) const
{
    const std::uint8_t built_in = static_built_in(*tables_, data_type);
    return built_in > last_built_in_type ? BuiltInType::Variant : BuiltInType{built_in};
}

std::uint32_t SpaceReader::built_in_types_of(NodeIndex data_type) const
{
    const std::uint8_t built_in = static_built_in(*tables_, data_type);
    switch (built_in) {
    case 0:
        return 0;
    case static_cast<std::uint8_t>(BuiltInType::Variant):
        return UINT32_MAX;
    case number_type:
        return number_bits;
    case integer_type:
        return signed_bits;
    case unsigned_type:
        return unsigned_bits;
    default:
        return bit(BuiltInType{built_in});
    }
}

NodeIndex SpaceReader::type_of_value(const Variant& value) const
{
    const auto* structure = value.get_if<ExtensionObject>();
    const auto* const structures = value.array_if<ExtensionObject>();
    if (structures != nullptr && !structures->empty()) {
        structure = &structures->front();
    }
    if (structure != nullptr && !structure->is_null()) {
        if (const NodeIndex type = structure_type(*this, *structure); type != no_node) {
            return type;
        }
    }
    // A built-in type's DataType has the type's own number (Part 6, 5.1.2).
    return value.is_null() ? no_node : find(static_cast<std::uint32_t>(value.type()));
}

StatusCode SpaceReader::check_value(const Variant& value, NodeIndex data_type,
                                    std::int32_t value_rank,
                                    std::span<const std::uint32_t> array_dimensions) const
{
    const std::uint32_t types = built_in_types_of(data_type);
    if (value.is_null()) {
        return (types & 1U) != 0 ? status::Good : status::Bad_TypeMismatch;
    }
    if (const auto* const bytes = value.get_if<ByteString>();
        bytes != nullptr && types == bit(BuiltInType::Byte) && fits_rank(1, value_rank)) {
        // Part 4, 5.11.4.2: it is accepted as an array of Byte.
        const bool fits = array_dimensions.size() != 1 || array_dimensions[0] == 0 ||
                          bytes->size() <= array_dimensions[0];
        return fits ? status::Good : status::Bad_TypeMismatch;
    }
    const bool fits =
        (types & bit(value.type())) != 0 && fits_rank(dimension_count(value), value_rank) &&
        fits_dimensions(value, array_dimensions) &&
        (types != bit(BuiltInType::ExtensionObject) || fit_structures(*this, value, data_type));
    return fits ? status::Good : status::Bad_TypeMismatch;
}

} // namespace busbar::model
