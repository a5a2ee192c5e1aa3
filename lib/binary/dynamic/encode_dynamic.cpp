#include <busbar/binary/dynamic_value.hpp>

#include "core/visit_built_in.hpp"

namespace busbar::binary {

namespace {

using busbar::encode;

void encode_structure(Writer& writer, const DynamicValue& value);

/// Writes the size of an array or matrix before its elements (Part 6, 5.2.5).
void encode_size(Writer& writer, const DynamicField& field, bool is_null, std::size_t count,
                 std::span<const std::uint32_t> dimensions)
{
    if (is_null && dimensions.empty()) {
        writer.number(std::int32_t{-1});
    } else if (field.is_matrix()) {
        writer.length(dimensions.size());
        writer.numbers(dimensions);
    } else {
        writer.length(count);
    }
}

template <typename T>
void encode_built_in(Writer& writer, const DynamicField& field, const Variant& value)
{
    if (const auto* const values = value.array_if<T>()) {
        encode_size(writer, field, values->is_null(), values->size(), value.dimensions());
        for (const T& element : *values) {
            encode(writer, element);
        }
    } else if constexpr (!std::is_same_v<T, Variant>) {
        encode(writer, *value.get_if<T>());
    }
}

void encode_content(Writer& writer, const DynamicField& field, const Variant& value)
{
    if (field.built_in == BuiltInType::Variant && field.is_scalar()) {
        encode(writer, value);
        return;
    }
    busbar::detail::visit_built_in(field.built_in, [&](auto tag) {
        encode_built_in<typename decltype(tag)::type>(writer, field, value);
    });
}

void encode_content(Writer& writer, const DynamicField& field, const DynamicArray& array)
{
    encode_size(writer, field, array.values.is_null(), array.values.size(),
                array.dimensions.span());
    for (const DynamicValue& value : array.values) {
        encode_structure(writer, value);
    }
}

/// Every field has content of its kind, as DynamicValue checks each set.
void encode_field(Writer& writer, const DynamicValue& value, std::size_t index)
{
    const DynamicField& field = value.type().fields[index];
    if (const Variant* const variant = value.value(index)) {
        encode_content(writer, field, *variant);
    } else if (const DynamicValue* const part = value.structure(index)) {
        encode_structure(writer, *part);
    } else if (const DynamicArray* const array = value.structures(index)) {
        encode_content(writer, field, *array);
    }
}

/// Returns one bit for each optional field that is present (Part 6, 5.2.7).
std::uint32_t encoding_mask(const DynamicValue& value)
{
    std::uint32_t mask = 0;
    std::uint32_t bit = 1;
    const auto& fields = value.type().fields;
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (fields[i].is_optional) {
            mask |= value.has(i) ? bit : 0U;
            bit <<= 1U;
        }
    }
    return mask;
}

void encode_structure(Writer& writer, const DynamicValue& value)
{
    if (!writer.enter()) {
        return;
    }
    const DynamicType& type = value.type();
    if (type.kind == DynamicType::Kind::Union) {
        writer.number(value.selected());
        if (value.selected() != 0) {
            encode_field(writer, value, value.selected() - 1);
        }
    } else {
        if (type.has_optional_fields) {
            writer.number(encoding_mask(value));
        }
        for (std::size_t i = 0; i < type.fields.size(); ++i) {
            encode_field(writer, value, i);
        }
    }
    writer.leave();
}

} // namespace

void encode(Writer& writer, const DynamicValue& value)
{
    encode_structure(writer, value);
}

Result<ExtensionObject> to_extension_object(const DynamicValue& value)
{
    if (value.type().encoding_id.is_null()) {
        return busbar::fail(status::Bad_EncodingError);
    }
    const auto bytes = to_bytes(value);
    if (!bytes) {
        return busbar::fail(bytes.error());
    }
    return ExtensionObject::from_binary(value.type().encoding_id, ByteString{std::span{*bytes}});
}

} // namespace busbar::binary
