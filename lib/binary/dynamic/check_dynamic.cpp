#include <busbar/binary/dynamic_value.hpp>

namespace busbar::binary {

namespace {

/// Looks at structures and whatever they hold encoded, at any depth up to a limit.
class DynamicCheck {
public:
    DynamicCheck(const DynamicTypes& types, const DecodeLimits& limits)
        : types_{types}, limits_{limits}
    {
    }

    [[nodiscard]] StatusCode variant(const Variant& value, const DynamicType* base)
    {
        if (const auto* const one = value.get_if<ExtensionObject>()) {
            return object(*one, base);
        }
        if (const auto* const all = value.array_if<ExtensionObject>()) {
            return first_bad(*all, [&](const ExtensionObject& each) { return object(each, base); });
        }
        if (const auto* const all = value.array_if<Variant>()) {
            return first_bad(*all, [&](const Variant& each) { return variant(each, nullptr); });
        }
        return status::Good;
    }

private:
    template <typename Values, typename Check>
    [[nodiscard]] static StatusCode first_bad(const Values& values, Check check)
    {
        for (const auto& value : values) {
            if (const StatusCode found = check(value); found.is_bad()) {
                return found;
            }
        }
        return status::Good;
    }

    [[nodiscard]] StatusCode object(const ExtensionObject& object, const DynamicType* base)
    {
        const DynamicType* const type = types_.find_encoding(object.encoding_id());
        if (object.is_null() || type == nullptr) {
            return status::Good;
        }
        if (base != nullptr && !type->is_subtype_of(*base)) {
            return status::Bad_TypeMismatch;
        }
        if (object.body() == ExtensionObject::Body::Object) {
            return status::Good; // its decoder has seen to that
        }
        const auto value = decode_dynamic(object, types_, limits_);
        if (!value) {
            return value.error();
        }
        if (depth_ == limits_.max_depth) {
            return status::Bad_EncodingLimitsExceeded;
        }
        ++depth_;
        const StatusCode found = structure(*value);
        --depth_;
        return found;
    }
    [[nodiscard]] StatusCode structure(const DynamicValue& value)
    {
        const auto& fields = value.type().fields;
        for (std::size_t i = 0; i < fields.size(); ++i) {
            if (const StatusCode found = field(value, i); found.is_bad()) {
                return found;
            }
        }
        return status::Good;
    }
    [[nodiscard]] StatusCode field(const DynamicValue& value, std::size_t index)
    {
        if (const Variant* const content = value.value(index)) {
            const DynamicField& of = value.type().fields[index];
            return variant(*content,
                           of.built_in == BuiltInType::ExtensionObject ? of.type : nullptr);
        }
        if (const DynamicValue* const part = value.structure(index)) {
            return structure(*part);
        }
        if (const DynamicArray* const parts = value.structures(index)) {
            return first_bad(parts->values,
                             [this](const DynamicValue& part) { return structure(part); });
        }
        return status::Good;
    }

    const DynamicTypes& types_;
    const DecodeLimits& limits_;
    std::uint32_t depth_{0};
};

} // namespace

StatusCode check_dynamic(const Variant& value, const DynamicTypes& types,
                         const DecodeLimits& limits)
{
    return DynamicCheck{types, limits}.variant(value, nullptr);
}

} // namespace busbar::binary
