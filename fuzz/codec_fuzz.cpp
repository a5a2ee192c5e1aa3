#include <cstdlib>
#include <memory>

#include <busbar/binary/codec.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/types/registry.hpp>

namespace codec_fuzz {

using namespace busbar;

namespace {

/// Whatever decodes must encode, and must then decode to the same value and bytes.
void check(bool condition)
{
    if (!condition) {
        std::abort();
    }
}

const binary::TypeRegistry& types()
{
    static const binary::TypeRegistry registry{binary::namespace0_types()};
    return registry;
}

template <typename T>
void round_trip(std::span<const std::byte> input)
{
    binary::Reader reader{input, binary::Strings::Borrow, &types()};
    T value{};
    decode(reader, value);
    if (!reader.ok()) {
        return;
    }
    const auto encoded = binary::to_bytes(value);
    check(encoded.has_value());
    const auto again = binary::from_bytes<T>(*encoded, &types());
    if (again) { // the canonical form may be larger than a limit that the input kept
        const auto bytes = binary::to_bytes(*again);
        check(bytes && *bytes == *encoded);
    }
}

std::vector<std::byte> bytes_of(const StructureType& type, const void* object)
{
    binary::VectorSink sink;
    binary::Writer writer{sink};
    type.encode(writer, object);
    check(writer.ok());
    return sink.take(writer.written());
}

void round_trip(const StructureType& type, std::span<const std::byte> input)
{
    const auto destroy = [&](void* object) { type.destroy(object); };
    const std::unique_ptr<void, decltype(destroy)> object{type.create(), destroy};
    binary::Reader reader{input, binary::Strings::Borrow, &types()};
    type.decode(reader, object.get());
    if (!reader.ok()) {
        return;
    }
    // Compared as bytes: a structure with a NaN in it does not equal itself.
    const std::unique_ptr<void, decltype(destroy)> copy{type.copy(object.get()), destroy};
    check(bytes_of(type, object.get()) == bytes_of(type, copy.get()));
}

using Entry = void (*)(std::span<const std::byte>);
constexpr Entry built_in_types[] = {
    round_trip<bool>,       round_trip<std::int16_t>,    round_trip<float>,
    round_trip<double>,     round_trip<String>,          round_trip<ByteString>,
    round_trip<XmlElement>, round_trip<DateTime>,        round_trip<Guid>,
    round_trip<NodeId>,     round_trip<ExpandedNodeId>,  round_trip<StatusCode>,
    round_trip<DataValue>,  round_trip<QualifiedName>,   round_trip<LocalizedText>,
    round_trip<Variant>,    round_trip<ExtensionObject>, round_trip<DiagnosticInfo>,
};

} // namespace

/// Two bytes choose the codec, the rest is its input.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    if (size < 2) {
        return 0;
    }
    const std::size_t choice = data[0] + std::size_t{data[1]} * 256;
    const auto input = std::as_bytes(std::span{data, size}).subspan(2);
    if (choice < std::size(built_in_types)) {
        built_in_types[choice](input);
    } else {
        const auto table = binary::namespace0_types();
        round_trip(*table[(choice - std::size(built_in_types)) % table.size()], input);
    }
    return 0;
}

} // namespace codec_fuzz
