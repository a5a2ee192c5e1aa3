#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/dynamic_types.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/core/api.hpp>

namespace busbar::binary {

struct DynamicArray;
struct DynamicContent;

/// A value of a structure or union that is known from its DataTypeDefinition (Part 6, 5.1.7).
///
/// An ordinary value that refers to its DynamicType, whose DynamicTypes must outlive it. Every
/// field always has content that fits its definition, because every set checks it: a built-in
/// value, enumeration or option set of any shape is a Variant, a structure a DynamicValue, an array
/// or matrix of structures a DynamicArray. Fields that may hold subtypes are ExtensionObjects or
/// Variants in a Variant. A moved-from value can only be assigned or destroyed. Thread-compatible.
class BUSBAR_API DynamicValue {
public:
    /// Creates a value of zeros and nulls, without optional fields; a union selects none of its
    /// fields. `type` must be a structure or union.
    explicit DynamicValue(const DynamicType& type);
    DynamicValue(const DynamicValue& other);
    DynamicValue(DynamicValue&& other) noexcept;
    DynamicValue& operator=(const DynamicValue& other);
    DynamicValue& operator=(DynamicValue&& other) noexcept;
    ~DynamicValue();

    [[nodiscard]] const DynamicType& type() const { return *type_; }
    /// The SwitchField of a union (Part 6, 5.2.8): 0 for none, else the index of the field + 1.
    [[nodiscard]] std::uint32_t selected() const { return selected_; }
    /// False for an optional field that is absent, a field that the union does not select, and an
    /// unknown name or index.
    [[nodiscard]] bool has(std::size_t field) const { return content(field) != nullptr; }
    [[nodiscard]] bool has(std::string_view field) const { return has(index_of(field)); }

    // The content of a field; null if it is absent or of another kind. Valid until this value is
    // changed.

    [[nodiscard]] const Variant* value(std::size_t field) const;
    [[nodiscard]] const Variant* value(std::string_view field) const
    {
        return value(index_of(field));
    }
    [[nodiscard]] const DynamicValue* structure(std::size_t field) const;
    [[nodiscard]] const DynamicValue* structure(std::string_view field) const
    {
        return structure(index_of(field));
    }
    [[nodiscard]] const DynamicArray* structures(std::size_t field) const;
    [[nodiscard]] const DynamicArray* structures(std::string_view field) const
    {
        return structures(index_of(field));
    }
    /// The scalar of a field if it is a T.
    template <BuiltIn T>
    [[nodiscard]] const T* get_if(std::string_view field) const
    {
        const Variant* const found = value(field);
        return found == nullptr ? nullptr : found->get_if<T>();
    }

    // Setting a field makes an optional one present, and selects that of a union. Bad_NotFound for
    // a field that does not exist, Bad_TypeMismatch for content of another type or shape; nothing
    // changes then.

    /// C++ objects of structures in `content` are encoded, as if they had come from the wire, so
    /// that equal values compare equal; errors are those of encode.
    Result<void> set(std::size_t field, Variant content);
    /// Sets a structure of the field's type, or of any subtype if the field allows subtypes.
    Result<void> set(std::size_t field, DynamicValue content);
    Result<void> set(std::size_t field, DynamicArray content);
    template <typename Content>
    Result<void> set(std::string_view field, Content content)
    {
        return set(index_of(field), std::move(content));
    }
    /// Makes an optional field absent, or the union select nothing. Bad_TypeMismatch for a
    /// mandatory field.
    Result<void> clear(std::size_t field);
    Result<void> clear(std::string_view field) { return clear(index_of(field)); }

    /// True if both have the same type and equal fields; NaN equals NaN.
    friend BUSBAR_API bool operator==(const DynamicValue& a, const DynamicValue& b);
    /// Joins the codec's overloads. Fails with Bad_EncodingLimitsExceeded past 100 levels.
    friend BUSBAR_API void encode(Writer& writer, const DynamicValue& value);

private:
    friend class DynamicDecoder;
    DynamicValue(const DynamicType& type, std::vector<DynamicContent> contents,
                 std::uint32_t selected);

    static constexpr std::size_t no_field = SIZE_MAX;
    [[nodiscard]] std::size_t index_of(std::string_view field) const
    {
        return type_->find_field(field).value_or(no_field);
    }
    /// Null if the field is not there.
    [[nodiscard]] const DynamicContent* content(std::size_t field) const;
    Result<void> replace(std::size_t field, DynamicContent content);

    const DynamicType* type_;
    /// One for each field; for a union only the selected one.
    std::vector<DynamicContent> contents_;
    std::uint32_t selected_{0};
};

/// An array or matrix of structures of one type (Part 6, 5.2.5). Null and empty are different.
struct DynamicArray {
    Array<DynamicValue> values;
    /// For a matrix two or more, whose product is the number of values; null for an array.
    Array<std::uint32_t> dimensions;

    friend bool operator==(const DynamicArray&, const DynamicArray&) = default;
};

/// The content of a field; nothing for an optional field that is absent.
struct DynamicContent : std::variant<std::monostate, Variant, DynamicValue, DynamicArray> {
    using Base = std::variant<std::monostate, Variant, DynamicValue, DynamicArray>;
    using Base::Base;
    [[nodiscard]] const Base& base() const { return *this; }
};

/// Returns `limits` with room for a value's C++ objects, which are larger than those of generated
/// types.
[[nodiscard]] constexpr DecodeLimits dynamic_decode_limits(DecodeLimits limits = {})
{
    limits.max_expansion = 200;
    return limits;
}

/// Decodes a value of `type` from all of `body`. Bad_DecodingError if it does not match the
/// definition or has bytes missing or left over; Bad_EncodingLimitsExceeded past the limits.
/// ExtensionObjects within the value stay encoded.
[[nodiscard]] BUSBAR_API Result<DynamicValue>
decode_dynamic(std::span<const std::byte> body, const DynamicType& type,
               const DecodeLimits& limits = dynamic_decode_limits());
/// Decodes the value that `object` holds. Bad_DecodingError also for a null object, one without a
/// binary body, and one whose encoding is not among the `types`.
[[nodiscard]] BUSBAR_API Result<DynamicValue>
decode_dynamic(const ExtensionObject& object, const DynamicTypes& types,
               const DecodeLimits& limits = dynamic_decode_limits());

/// Returns Good, or why `value` must not be written: checks every structure in it whose type is one
/// of the `types`, also in arrays and within each other. The errors are those of decode_dynamic;
/// Bad_TypeMismatch if a field that allows subtypes holds something else; Bad_OutOfRange for a
/// dimension or text that is longer than its field allows (Part 3, 8.51; Part 4, 5.11.4.4). Only
/// structures that are C++ objects take memory, since they are encoded first; levels are counted
/// through everything that is encoded within something else.
[[nodiscard]] BUSBAR_API StatusCode
check_dynamic(const Variant& value, const DynamicTypes& types,
              const DecodeLimits& limits = dynamic_decode_limits());

/// Returns the value with the encoding id of its type. Bad_EncodingError for a type that has none.
[[nodiscard]] BUSBAR_API Result<ExtensionObject> to_extension_object(const DynamicValue& value);

/// Converts a generated structure into a dynamic value; errors as decode_dynamic. `namespace_index`
/// is the index of the type's namespace in the server.
template <typename T>
[[nodiscard]] Result<DynamicValue> to_dynamic(const T& object, const DynamicTypes& types,
                                              std::uint16_t namespace_index = 0)
{
    return decode_dynamic(ExtensionObject::from(object, namespace_index), types);
}
/// Converts a dynamic value into a generated structure. Bad_TypeMismatch if it is of another type;
/// Bad_DecodingError if the definition is not that of the generated type.
template <typename T>
[[nodiscard]] Result<T> to_generated(const DynamicValue& value, const TypeRegistry* registry,
                                     std::uint16_t namespace_index = 0)
{
    if (value.type().encoding_id != T::type.binary_encoding_id.in(namespace_index)) {
        return busbar::fail(status::Bad_TypeMismatch);
    }
    const auto bytes = to_bytes(value);
    return bytes ? from_bytes<T>(*bytes, registry) : busbar::fail(bytes.error());
}

/// Limits how much of a value is printed. "..." replaces the rest.
struct TextLimits {
    std::size_t max_bytes{4'096};
    /// Elements of each array, and bytes of each ByteString.
    std::size_t max_elements{32};
    /// Bytes of each string.
    std::size_t max_string{256};
    std::size_t max_depth{16};
    /// Digits to which Doubles and Floats are rounded; 0: as many as it takes to read them back.
    int max_digits{0};
};

/// The known types of printed values. Must outlive the call.
struct TextTypes {
    /// Structures with one of these encodings are printed with their fields.
    const DynamicTypes* types{nullptr};
    /// The DataType of a Variant, for the names of an enumeration's values and the times of IEC
    /// 61131-3: those of TIME, TOD, DATE and DT are literals such as T#1s500ms.
    const DynamicType* type{nullptr};
};

/// Returns "Point {X: 1.5, Name: "left", Mode: Running (1), Tags: ["a", null]}", for people, not
/// for parsing. Strings are quoted, and escaped as by printable(). At most about max_bytes long.
[[nodiscard]] BUSBAR_API std::string
to_text(const DynamicValue& value, const TextLimits& limits = {}, const TextTypes& types = {});
[[nodiscard]] BUSBAR_API std::string to_text(const Variant& value, const TextLimits& limits = {},
                                             const TextTypes& types = {});

} // namespace busbar::binary
