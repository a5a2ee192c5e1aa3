#include "body_walk.hpp"

#include <algorithm>

#include "binary/data_value_wire.hpp"
#include "binary/wire_masks.hpp"
#include "core/visit_built_in.hpp"
#include "matrix_header.hpp"

namespace busbar::binary::detail {

namespace {

/// Returns the levels that are left within `depth` others.
DecodeLimits limits_within(DecodeLimits limits, std::uint32_t depth)
{
    limits.max_depth -= std::min(limits.max_depth, depth);
    return limits;
}

} // namespace

BodyWalk::BodyWalk(const CheckContext& context, std::span<const std::byte> body,
                   std::uint32_t depth)
    : context_{context},
      reader_{body, Strings::Borrow, nullptr, limits_within(context.limits, depth)}, depth_{depth}
{
    if (depth > context.limits.max_depth) {
        reader_.fail(status::Bad_EncodingLimitsExceeded);
    }
}

StatusCode BodyWalk::run(const DynamicType& type)
{
    structure(type);
    if (reader_.ok() && reader_.remaining() != 0) {
        reader_.fail(status::Bad_DecodingError);
    }
    return reader_.status();
}

bool BodyWalk::enter()
{
    if (!reader_.enter()) {
        return false;
    }
    ++depth_;
    return true;
}

void BodyWalk::leave()
{
    reader_.leave();
    --depth_;
}

void BodyWalk::structure(const DynamicType& type)
{
    const bool is_union = type.kind == DynamicType::Kind::Union;
    const std::size_t most = is_union ? 1 : type.fields.size();
    if (!enter()) {
        return;
    }
    // The work for a byte has the decoder's limit: a field may take no byte at all.
    if (reader_.charge(most * sizeof(DynamicContent))) {
        if (is_union) {
            union_field(type);
        } else {
            fields(type);
        }
    }
    leave();
}

void BodyWalk::union_field(const DynamicType& type)
{
    const auto selected = reader_.number<std::uint32_t>();
    if (selected > type.fields.size()) { // Part 6, 5.2.8
        reader_.fail(status::Bad_DecodingError);
    } else if (selected != 0) {
        content(type.fields[selected - 1]);
    }
}

void BodyWalk::fields(const DynamicType& type)
{
    std::uint32_t mask = type.has_optional_fields ? reader_.number<std::uint32_t>() : 0;
    for (const DynamicField& field : type.fields) {
        if (!reader_.ok()) {
            return;
        }
        const bool is_absent = field.is_optional && (mask & 1U) == 0;
        mask >>= field.is_optional ? 1U : 0U;
        if (!is_absent) {
            content(field);
        }
    }
    if (mask != 0) { // Part 6, 5.2.7
        reader_.fail(status::Bad_DecodingError);
    }
}

void BodyWalk::content(const DynamicField& field)
{
    if (!field.is_structure) {
        busbar::detail::visit_built_in(
            field.built_in, [&](auto tag) { built_in<typename decltype(tag)::type>(field); });
        return;
    }
    if (field.is_scalar()) {
        return structure(*field.type);
    }
    const std::int64_t count = array_size(field, field.type->min_wire_size, sizeof(DynamicValue));
    for (std::int64_t i = 0; i < count && reader_.ok(); ++i) {
        structure(*field.type);
    }
}

/// Returns the number of elements of an array or matrix; 0 for a null one.
std::int64_t BodyWalk::array_size(const DynamicField& field, std::size_t min_element_size,
                                  std::size_t object_size)
{
    std::size_t dimension = 0;
    const auto check_dimension = [&](std::uint32_t length) {
        const auto& limits = field.array_dimensions;
        const std::uint32_t most = dimension < limits.size() ? limits[dimension] : 0;
        ++dimension;
        if (most != 0 && length > most && context_.limits_arrays) {
            reader_.fail(status::Bad_OutOfRange);
        }
    };
    if (field.is_matrix()) {
        return decode_matrix_header(reader_, field, min_element_size, object_size, check_dimension);
    }
    const std::int32_t count = reader_.array_length(min_element_size, object_size);
    if (count > 0) {
        check_dimension(static_cast<std::uint32_t>(count));
    }
    return count;
}

template <typename T>
void BodyWalk::built_in(const DynamicField& field)
{
    if (!field.is_scalar()) {
        const std::size_t least = busbar::detail::min_wire_size<T>();
        return elements<T>(array_size(field, least, sizeof(T)), &field);
    }
    if constexpr (sizeof(T) > sizeof(Variant)) {
        if (!reader_.charge(sizeof(T))) {
            return;
        }
    }
    element<T>(&field);
}

/// Checks one value of the field, or of no particular field.
template <typename T>
void BodyWalk::element(const DynamicField* field)
{
    if constexpr (std::is_same_v<T, Variant>) {
        const auto type = static_cast<unsigned>(variant());
        const std::uint32_t allowed = field == nullptr ? UINT32_MAX : field->variant_types;
        if (type != 0 && ((allowed >> type) & 1U) == 0) {
            reader_.fail(status::Bad_DecodingError);
        }
    } else if constexpr (std::is_same_v<T, DataValue>) {
        data_value();
    } else if constexpr (std::is_same_v<T, DiagnosticInfo>) {
        diagnostic_info();
    } else {
        T value{};
        decode(reader_, value);
        if constexpr (std::is_same_v<T, ExtensionObject>) {
            const DynamicType* const base = field == nullptr ? nullptr : field->type;
            const StatusCode found =
                reader_.ok() ? check_object(context_, value, base, depth_) : status::Good;
            if (found.is_bad()) {
                reader_.fail(found);
            }
        } else if constexpr (std::is_same_v<T, LocalizedText>) {
            check_length(field, value.text.size());
        } else if constexpr (busbar::detail::is_text<T>) {
            check_length(field, value.size());
        }
    }
}

template <typename T>
void BodyWalk::elements(std::int64_t count, const DynamicField* field)
{
    if constexpr (busbar::detail::WireNumber<T>) {
        if (count > 0) {
            reader_.skip(static_cast<std::size_t>(count) * sizeof(T));
        }
    } else {
        for (std::int64_t i = 0; i < count && reader_.ok(); ++i) {
            element<T>(field);
        }
    }
}

void BodyWalk::check_length(const DynamicField* field, std::size_t length)
{
    if (field != nullptr && field->max_string_length != 0 && length > field->max_string_length) {
        reader_.fail(status::Bad_OutOfRange);
    }
}

/// Returns the type of the Variant's content.
BuiltInType BodyWalk::variant()
{
    namespace mask = busbar::detail::variant_mask;
    const unsigned bits = reader_.number<std::uint8_t>();
    if (bits == 0 || !reader_.ok()) {
        return BuiltInType::Null;
    }
    if (!mask::is_valid(bits)) {
        reader_.fail(status::Bad_DecodingError);
        return BuiltInType::Null;
    }
    const BuiltInType type = mask::type_of(bits);
    if (enter()) {
        busbar::detail::visit_built_in(type, [&](auto tag) {
            using T = typename decltype(tag)::type;
            if ((bits & mask::array) != 0) {
                variant_array<T>((bits & mask::dimensions) != 0);
            } else {
                variant_scalar<T>();
            }
        });
        leave();
    }
    return type;
}

template <typename T>
void BodyWalk::variant_scalar()
{
    if constexpr (std::is_same_v<T, Variant>) {
        reader_.fail(status::Bad_DecodingError); // Part 6, 5.2.2.16: only in arrays
    } else {
        if (sizeof(T) <= sizeof(Variant) || reader_.charge(sizeof(T))) {
            element<T>(nullptr);
        }
    }
}

template <typename T>
void BodyWalk::variant_array(bool has_dimensions)
{
    const std::int32_t count = reader_.array_length(busbar::detail::min_wire_size<T>(), sizeof(T));
    elements<T>(count, nullptr);
    if (has_dimensions) {
        variant_dimensions(count < 0 ? 0 : static_cast<std::size_t>(count));
    }
}

/// Part 6, 5.2.2.16: the product of the dimensions after an array is its length.
void BodyWalk::variant_dimensions(std::size_t count)
{
    const std::int32_t rank = reader_.array_length(sizeof(std::uint32_t), sizeof(std::uint32_t));
    std::size_t product = 1;
    for (std::int32_t i = 0; i < rank; ++i) {
        const auto dimension = reader_.number<std::uint32_t>();
        if (dimension > INT32_MAX) {
            reader_.fail(status::Bad_DecodingError);
        }
        product = times_dimension(product, dimension, INT32_MAX);
    }
    if (rank > 0 && product != count) {
        reader_.fail(status::Bad_DecodingError);
    }
}

void BodyWalk::data_value()
{
    namespace bits = busbar::detail::data_value_mask;
    busbar::detail::read_data_value(reader_, [this](auto bit) {
        using Bit = decltype(bit);
        if constexpr (std::is_same_v<Bit, bits::Value>) {
            static_cast<void>(variant());
        } else if constexpr (std::is_same_v<Bit, bits::Status>) {
            reader_.skip(sizeof(std::uint32_t));
        } else if constexpr (std::is_same_v<Bit, bits::SourceTimestamp> ||
                             std::is_same_v<Bit, bits::ServerTimestamp>) {
            reader_.skip(sizeof(std::int64_t));
        } else {
            reader_.skip(sizeof(std::uint16_t));
        }
    });
}

void BodyWalk::diagnostic_info()
{
    namespace bits = busbar::detail::diagnostic_info_mask;
    const unsigned mask = reader_.number<std::uint8_t>();
    if ((mask & bits::reserved) != 0) {
        reader_.fail(status::Bad_DecodingError);
    }
    if (!reader_.enter_diagnostic()) {
        return;
    }
    for (const unsigned number :
         {bits::symbolic_id, bits::namespace_uri, bits::locale, bits::localized_text}) {
        reader_.skip((mask & number) != 0 ? sizeof(std::int32_t) : 0);
    }
    if ((mask & bits::additional_info) != 0) {
        element<String>(nullptr);
    }
    reader_.skip((mask & bits::inner_status_code) != 0 ? sizeof(std::uint32_t) : 0);
    if ((mask & bits::inner_diagnostic_info) != 0 && reader_.charge(sizeof(DiagnosticInfo))) {
        diagnostic_info();
    }
    reader_.leave_diagnostic();
}

} // namespace busbar::binary::detail
