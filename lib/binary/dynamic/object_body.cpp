#include "object_body.hpp"

namespace busbar::binary::detail {

namespace {

constexpr unsigned max_depth = 100; // Part 6, 5.1.5

Result<void> encode_within(Variant& value, unsigned depth);

Result<void> encode_one(ExtensionObject& object, unsigned /*depth*/)
{
    if (object.body() != ExtensionObject::Body::Object) {
        return {};
    }
    const auto bytes = encoded_body(object);
    if (!bytes) {
        return busbar::fail(bytes.error());
    }
    object = ExtensionObject::from_binary(object.encoding_id(), ByteString{std::span{*bytes}});
    return {};
}

Result<void> encode_one(Variant& value, unsigned depth)
{
    return encode_within(value, depth);
}

Result<void> encode_one(DataValue& value, unsigned depth)
{
    return encode_within(value.value, depth);
}

template <typename T>
Result<void> encode_all(Array<T>& values, unsigned depth)
{
    for (T& value : values) {
        if (auto done = encode_one(value, depth); !done) {
            return done;
        }
    }
    return {};
}

Result<void> encode_within(Variant& value, unsigned depth)
{
    if (depth > max_depth) {
        return busbar::fail(status::Bad_EncodingLimitsExceeded);
    }
    if (auto* const object = value.get_if<ExtensionObject>()) {
        return encode_one(*object, depth + 1);
    }
    if (auto* const objects = value.array_if<ExtensionObject>()) {
        return encode_all(*objects, depth + 1);
    }
    if (auto* const data = value.get_if<DataValue>()) {
        return encode_one(*data, depth + 1);
    }
    if (auto* const all = value.array_if<DataValue>()) {
        return encode_all(*all, depth + 1);
    }
    if (auto* const variants = value.array_if<Variant>()) {
        return encode_all(*variants, depth + 1);
    }
    return {};
}

} // namespace

Result<std::vector<std::byte>> encoded_body(const ExtensionObject& object)
{
    VectorSink sink;
    Writer writer{sink};
    object.type()->encode(writer, object.object());
    if (!writer.ok()) {
        return busbar::fail(writer.status());
    }
    return sink.take(writer.written());
}

Result<void> encode_objects(Variant& value)
{
    return encode_within(value, 0);
}

} // namespace busbar::binary::detail
