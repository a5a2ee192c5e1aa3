#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <busbar/binary/codec.hpp>
#include <busbar/server/image_memory.hpp>

#include "fuzz_script.hpp"
#include "server/image/image_types.hpp"

/// Variables of a process image and values for them, as a script would have them.
namespace busbar::fuzz {

using Bytes = std::vector<std::byte>;

inline std::vector<std::uint32_t> dimensions(Script& script)
{
    const std::uint8_t shape = script.byte();
    switch (shape % 8) {
    case 4:
        return {1U + shape / 64};
    case 5:
        return {1U + shape / 128, 3};
    case 6:
        return {2, 1, 1U + shape / 64};
    case 7: // what there is no room for, and what is nothing
        return shape < 0xe0 ? std::vector<std::uint32_t>{5}
                            : std::vector<std::uint32_t>{0x10000U + shape, shape % 16 * 0x1111U};
    default:
        return {};
    }
}

inline BuiltInType type(Script& script)
{
    static constexpr std::array types{
        BuiltInType::Int32,      BuiltInType::String,   BuiltInType::ExtensionObject,
        BuiltInType::Boolean,    BuiltInType::SByte,    BuiltInType::Byte,
        BuiltInType::Int16,      BuiltInType::UInt16,   BuiltInType::UInt32,
        BuiltInType::Int64,      BuiltInType::UInt64,   BuiltInType::Float,
        BuiltInType::Double,     BuiltInType::DateTime, BuiltInType::Guid,
        BuiltInType::ByteString, BuiltInType::Variant,  BuiltInType::XmlElement,
        BuiltInType::StatusCode};
    return types.at(script.byte() % types.size());
}

/// Structures are of up to three levels.
inline server::ImageVariable variable(Script& script, int level = 0)
{
    server::ImageVariable made;
    made.type = type(script);
    made.dimensions = dimensions(script);
    const std::uint8_t flags = script.byte();
    made.capacity = flags % 16 == 15 ? UINT32_MAX - flags : flags % 16;
    made.is_read_only = flags >= 0xf0;
    if ((flags & 0x40U) != 0) {
        made.range = server::ImageRange{-static_cast<std::int64_t>(script.byte()), script.byte()};
    }
    if (made.type == BuiltInType::ExtensionObject && level < 3) {
        std::vector<server::ImageVariable> members;
        for (int i = script.byte() % 4; i >= 0; --i) {
            members.push_back(variable(script, level + 1));
        }
        const auto structure = server::ImageStructure::create(NodeId{1, 17U}, members);
        made.structure = structure ? *structure : nullptr;
    }
    return made;
}

template <typename T>
T element(Script& script)
{
    const std::uint8_t byte = script.byte();
    if constexpr (std::is_arithmetic_v<T>) {
        return static_cast<T>(byte - 64);
    } else if constexpr (std::is_same_v<T, ByteString>) {
        return byte == 0 ? T{} : T{Bytes(byte % 16, std::byte{byte})};
    } else if constexpr (server::detail::is_image_text<T>) {
        return byte == 0 ? T{} : T{String{std::string(byte % 16, 'x')}};
    } else if constexpr (std::is_same_v<T, DateTime>) {
        return DateTime{byte};
    } else if constexpr (std::is_same_v<T, StatusCode>) {
        return StatusCode{byte * 0x01000000U};
    } else {
        T guid;
        guid.data1 = byte;
        return guid;
    }
}

inline std::size_t product(const std::vector<std::uint32_t>& dimensions)
{
    std::size_t count = 1;
    for (const std::uint32_t dimension : dimensions) {
        count *= dimension;
    }
    return count;
}

/// Numbers or texts of any image type, in that shape.
inline Variant plain_value(BuiltInType type, const std::vector<std::uint32_t>& dimensions,
                           Script& script)
{
    return server::detail::visit_image_type(
        type,
        [&](auto tag) {
            using T = typename decltype(tag)::type;
            if (dimensions.empty()) {
                return Variant{element<T>(script)};
            }
            Array<T> values;
            values.reserve(1);
            for (std::size_t left = product(dimensions); left != 0; --left) {
                values.push_back(element<T>(script));
            }
            return Variant::matrix(std::move(values), Array<std::uint32_t>{dimensions});
        },
        [] { return Variant{}; });
}

/// Structures like `like`, of which the script changes bytes.
inline Variant structures(const ExtensionObject& like, const std::vector<std::uint32_t>& dimensions,
                          Script& script)
{
    Array<ExtensionObject> values;
    values.reserve(1);
    for (std::size_t left = product(dimensions); left != 0; --left) {
        const auto body = like.binary().span();
        Bytes changed{body.begin(), body.end()};
        for (int i = script.byte() % 3; i != 0 && !changed.empty(); --i) {
            changed[script.byte() % changed.size()] = static_cast<std::byte>(script.byte());
        }
        values.push_back(ExtensionObject::from_binary(like.encoding_id(), ByteString{changed}));
    }
    return dimensions.empty()
               ? Variant{std::move(values[0])}
               : Variant::matrix(std::move(values), Array<std::uint32_t>{dimensions});
}

/// A value for the variable that is `now`, in its shape or another.
inline Variant value_for(const server::ImagePlace& place, const Variant& now,
                         const std::vector<std::uint32_t>& dimensions, Script& script)
{
    if (!place.is_structure()) {
        return plain_value(place.type, dimensions, script);
    }
    const auto* one = now.get_if<ExtensionObject>();
    const auto* several = now.array_if<ExtensionObject>();
    return structures(one != nullptr ? *one : (*several)[0], dimensions, script);
}

/// For comparing: of numbers that are none, too.
inline Bytes wire(const Variant& value)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    encode(writer, value);
    return sink.take(writer.written());
}

} // namespace busbar::fuzz
