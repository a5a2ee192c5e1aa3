#include <busbar/binary/dynamic_value.hpp>

#include "body_walk.hpp"
#include "object_body.hpp"

namespace busbar::binary {

namespace {

using detail::CheckContext;

template <typename Values, typename Check>
StatusCode first_bad(const Values& values, Check check)
{
    for (const auto& value : values) {
        if (const StatusCode found = check(value); found.is_bad()) {
            return found;
        }
    }
    return status::Good;
}

/// The nesting of Variants has been checked when they were decoded.
StatusCode check_variant(const CheckContext& context, const Variant& value)
{
    const auto check_one = [&](const ExtensionObject& each) {
        return check_object(context, each, nullptr, 0);
    };
    if (const auto* const one = value.get_if<ExtensionObject>()) {
        return check_one(*one);
    }
    if (const auto* const all = value.array_if<ExtensionObject>()) {
        return first_bad(*all, check_one);
    }
    if (const auto* const one = value.get_if<DataValue>()) {
        return check_variant(context, one->value);
    }
    if (const auto* const all = value.array_if<DataValue>()) {
        return first_bad(*all,
                         [&](const DataValue& each) { return check_variant(context, each.value); });
    }
    if (const auto* const all = value.array_if<Variant>()) {
        return first_bad(*all, [&](const Variant& each) { return check_variant(context, each); });
    }
    return status::Good;
}

/// Checks a decoded value of a C++ type: the definition may allow less, and values that are still
/// encoded in it have not been checked yet.
StatusCode check_decoded(const CheckContext& context, const ExtensionObject& object,
                         const DynamicType& type, std::uint32_t depth)
{
    const auto bytes = detail::encoded_body(object);
    return bytes ? detail::BodyWalk{context, *bytes, depth}.run(type) : bytes.error();
}

} // namespace

StatusCode detail::check_object(const CheckContext& context, const ExtensionObject& object,
                                const DynamicType* base, std::uint32_t depth)
{
    const DynamicType* const type = context.types.find_encoding(object.encoding_id());
    if (type == nullptr) {
        return status::Good;
    }
    if (base != nullptr && !type->is_subtype_of(*base)) {
        return status::Bad_TypeMismatch;
    }
    switch (object.body()) {
    case ExtensionObject::Body::Binary:
        return BodyWalk{context, object.binary().span(), depth}.run(*type);
    case ExtensionObject::Body::Object:
        return check_decoded(context, object, *type, depth);
    case ExtensionObject::Body::None:
    case ExtensionObject::Body::Xml:
        break;
    }
    return status::Bad_DecodingError;
}

StatusCode check_dynamic(const Variant& value, const DynamicTypes& types,
                         const DecodeLimits& limits)
{
    return check_variant({types, limits}, value);
}

StatusCode detail::check_dynamic_of_any_length(const Variant& value, const DynamicTypes& types,
                                               const DecodeLimits& limits)
{
    return check_variant({types, limits, false}, value);
}

} // namespace busbar::binary
