#include <busbar/binary/dynamic_value.hpp>

#include "body_walk.hpp"
#include "core/visit_built_in.hpp"
#include "matrix_header.hpp"
#include "object_body.hpp"

namespace busbar::binary {

namespace {

/// Reads as decode_matrix_header, and stores the dimensions: none for a matrix without elements,
/// null or empty as encoded.
std::int64_t decode_header(Reader& reader, const DynamicField& field, std::size_t min_element_size,
                           std::size_t object_size, Array<std::uint32_t>& dimensions)
{
    const std::int64_t count = detail::decode_matrix_header(
        reader, field, min_element_size, object_size,
        [&](std::uint32_t dimension) { dimensions.push_back(dimension); });
    if (count >= 0 && dimensions.is_null()) {
        dimensions.clear();
    }
    return count;
}

template <typename T>
Variant decode_matrix(Reader& reader, const DynamicField& field)
{
    Array<std::uint32_t> dimensions;
    Array<T> values;
    const std::int64_t count =
        decode_header(reader, field, busbar::detail::min_wire_size<T>(), sizeof(T), dimensions);
    if (count < 0) {
        return Variant{std::move(values)};
    }
    values.resize(static_cast<std::size_t>(count));
    for (T& value : values) {
        decode(reader, value);
    }
    return Variant::matrix(std::move(values), std::move(dimensions));
}

template <typename T>
Variant decode_built_in(Reader& reader, const DynamicField& field)
{
    if (field.is_matrix()) {
        return decode_matrix<T>(reader, field);
    }
    if (!field.is_scalar()) {
        Array<T> values;
        decode(reader, values);
        return Variant{std::move(values)};
    }
    if (sizeof(T) > sizeof(Variant) && !reader.charge(sizeof(T))) {
        return {}; // the Variant would box it
    }
    T value{};
    decode(reader, value);
    return Variant{std::move(value)};
}

} // namespace

/// Reads what a definition describes; errors stay in the Reader, and results after an error are
/// meaningless.
class DynamicDecoder {
public:
    explicit DynamicDecoder(Reader& reader) : reader_{reader} {}

    [[nodiscard]] DynamicValue structure(const DynamicType& type)
    {
        const bool is_union = type.kind == DynamicType::Kind::Union;
        const std::size_t most = is_union ? 1 : type.fields.size();
        std::vector<DynamicContent> contents;
        std::uint32_t selected = 0;
        if (reader_.enter()) {
            if (reader_.charge(most * sizeof(DynamicContent))) {
                contents.reserve(most);
                if (is_union) {
                    selected = union_field(type, contents);
                } else {
                    fields(type, contents);
                }
            }
            reader_.leave();
        }
        return {type, std::move(contents), selected};
    }

private:
    std::uint32_t union_field(const DynamicType& type, std::vector<DynamicContent>& contents)
    {
        const auto selected = reader_.number<std::uint32_t>();
        if (selected > type.fields.size()) { // Part 6, 5.2.8
            reader_.fail(status::Bad_DecodingError);
            return 0;
        }
        if (selected != 0) {
            contents.push_back(content(type.fields[selected - 1]));
        }
        return selected;
    }
    void fields(const DynamicType& type, std::vector<DynamicContent>& contents)
    {
        std::uint32_t mask = type.has_optional_fields ? reader_.number<std::uint32_t>() : 0;
        for (const DynamicField& field : type.fields) {
            if (!reader_.ok()) {
                return;
            }
            const bool is_absent = field.is_optional && (mask & 1U) == 0;
            mask >>= field.is_optional ? 1U : 0U;
            contents.push_back(is_absent ? DynamicContent{} : content(field));
        }
        if (mask != 0) { // Part 6, 5.2.7
            reader_.fail(status::Bad_DecodingError);
        }
    }
    [[nodiscard]] DynamicContent content(const DynamicField& field)
    {
        if (!field.is_structure) {
            return built_in(field);
        }
        if (field.is_scalar()) {
            return structure(*field.type);
        }
        return array(field);
    }
    [[nodiscard]] DynamicContent built_in(const DynamicField& field)
    {
        if (field.built_in == BuiltInType::Variant && field.is_scalar()) {
            Variant value;
            decode(reader_, value);
            return checked(field, std::move(value));
        }
        return checked(field, busbar::detail::visit_built_in(field.built_in, [&](auto tag) {
                           using T = typename decltype(tag)::type;
                           if constexpr (std::is_same_v<T, Variant>) {
                               return field.is_matrix() ? decode_matrix<T>(reader_, field)
                                                        : variants();
                           } else {
                               return decode_built_in<T>(reader_, field);
                           }
                       }));
    }
    [[nodiscard]] Variant variants()
    {
        Array<Variant> values;
        decode(reader_, values);
        return Variant{std::move(values)};
    }
    /// A Variant may contain a value that the field's DataType does not allow.
    [[nodiscard]] DynamicContent checked(const DynamicField& field, Variant value)
    {
        if (reader_.ok() && !detail::fits(field, value)) {
            reader_.fail(status::Bad_DecodingError);
        }
        return value;
    }
    [[nodiscard]] DynamicArray array(const DynamicField& field)
    {
        DynamicArray result;
        const std::size_t least = field.type->min_wire_size;
        const std::int64_t count =
            field.is_matrix()
                ? decode_header(reader_, field, least, sizeof(DynamicValue), result.dimensions)
                : reader_.array_length(least, sizeof(DynamicValue));
        if (count < 0) {
            return result;
        }
        result.values.reserve(static_cast<std::size_t>(count));
        for (std::int64_t i = 0; i < count && reader_.ok(); ++i) {
            result.values.push_back(structure(*field.type));
        }
        return result;
    }

    Reader& reader_;
};

Result<DynamicValue> decode_dynamic(std::span<const std::byte> body, const DynamicType& type,
                                    const DecodeLimits& limits)
{
    if (!type.is_structure()) {
        return busbar::fail(status::Bad_DecodingError);
    }
    Reader reader{body, Strings::Own, nullptr, limits};
    DynamicValue value = DynamicDecoder{reader}.structure(type);
    if (reader.ok() && reader.remaining() != 0) {
        reader.fail(status::Bad_DecodingError);
    }
    if (!reader.ok()) {
        return busbar::fail(reader.status());
    }
    return value;
}

Result<DynamicValue> decode_dynamic(const ExtensionObject& object, const DynamicTypes& types,
                                    const DecodeLimits& limits)
{
    const DynamicType* const type = types.find_encoding(object.encoding_id());
    if (type == nullptr) {
        return busbar::fail(status::Bad_DecodingError);
    }
    if (object.body() == ExtensionObject::Body::Binary) {
        return decode_dynamic(object.binary().span(), *type, limits);
    }
    if (object.body() != ExtensionObject::Body::Object) {
        return busbar::fail(status::Bad_DecodingError);
    }
    const auto bytes = detail::encoded_body(object);
    return bytes ? decode_dynamic(*bytes, *type, limits) : busbar::fail(bytes.error());
}

} // namespace busbar::binary
