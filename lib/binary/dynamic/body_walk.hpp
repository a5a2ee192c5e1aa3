#pragma once

#include <busbar/binary/dynamic_value.hpp>

namespace busbar::binary::detail {

/// The rules of a check of structures.
struct CheckContext {
    const DynamicTypes& types;
    const DecodeLimits& limits;
    bool limits_arrays{true};
};

/// Checks like check_dynamic, but accepts arrays that are longer than their fields allow.
[[nodiscard]] BUSBAR_API StatusCode check_dynamic_of_any_length(const Variant& value,
                                                                const DynamicTypes& types,
                                                                const DecodeLimits& limits);

/// Returns Good, or why `object` is not a valid structure of type `base` (null: any), `depth`
/// levels deep. Good for null and for a structure that is not among the types.
[[nodiscard]] StatusCode check_object(const CheckContext& context, const ExtensionObject& object,
                                      const DynamicType* base, std::uint32_t depth);

/// Walks through the bytes of a structure as decode_dynamic would, and into the ExtensionObjects
/// there, but creates no objects: it takes stack for each level of nesting and no other memory.
///
/// Refuses what the decoder refuses, within the same limits, and what a field's ArrayDimensions and
/// MaxStringLength do not allow (Part 3, 8.51).
class BodyWalk {
public:
    /// The body is nested within `depth` levels.
    BodyWalk(const CheckContext& context, std::span<const std::byte> body, std::uint32_t depth);

    [[nodiscard]] StatusCode run(const DynamicType& type);

private:
    [[nodiscard]] bool enter();
    void leave();

    void structure(const DynamicType& type);
    void union_field(const DynamicType& type);
    void fields(const DynamicType& type);
    void content(const DynamicField& field);
    [[nodiscard]] std::int64_t array_size(const DynamicField& field, std::size_t min_element_size,
                                          std::size_t object_size);
    template <typename T>
    void built_in(const DynamicField& field);
    template <typename T>
    void element(const DynamicField* field);
    template <typename T>
    void elements(std::int64_t count, const DynamicField* field);
    void check_length(const DynamicField* field, std::size_t length);

    [[nodiscard]] BuiltInType variant();
    template <typename T>
    void variant_scalar();
    template <typename T>
    void variant_array(bool has_dimensions);
    void variant_dimensions(std::size_t count);
    void data_value();
    void diagnostic_info();

    const CheckContext& context_;
    Reader reader_;
    std::uint32_t depth_;
};

/// Tells whether content fits a field: the rules that every DynamicValue keeps.
[[nodiscard]] bool fits(const DynamicField& field, const Variant& content);
[[nodiscard]] bool fits(const DynamicField& field, const DynamicValue& content);
[[nodiscard]] bool fits(const DynamicField& field, const DynamicArray& content);
/// True for a structure that a field which allows subtypes can hold as ExtensionObject.
[[nodiscard]] bool may_be_subtype(const DynamicField& field, const DynamicValue& content);

/// True if a scalar field of Variants may hold `content`.
[[nodiscard]] bool fits_variant(const DynamicField& field, const Variant& content);

} // namespace busbar::binary::detail
