#include <cstdlib>
#include <string>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/types/ids.hpp>

#include "fuzz_script.hpp"

namespace dynamic_fuzz {

using namespace busbar;

namespace {

using binary::DataTypeEntry;
using fuzz::Script;

void check(bool condition)
{
    if (!condition) {
        std::abort();
    }
}

/// One byte chooses among all built-in types, the roots of the hierarchy, and the input's own.
NodeId choose_type(Script& script)
{
    const std::uint32_t choice = script.byte();
    if (choice < 64) {
        return NodeId{0, choice};
    }
    constexpr std::uint32_t others[] = {id::Decimal, id::OptionSet, id::Union};
    return choice < 67 ? NodeId{0, others[choice - 64]} : NodeId{1, choice % 9};
}

DataTypeEntry structure(Script& script, std::uint32_t number)
{
    StructureDefinition definition;
    definition.structure_type = static_cast<StructureDefinitionType>(script.byte() % 6);
    definition.default_encoding_id = NodeId{1, 100 + number};
    for (unsigned count = script.byte() % 6U; count != 0; --count) {
        StructureField field;
        field.name = "F" + std::to_string(script.byte() % 32);
        field.data_type = choose_type(script);
        const unsigned shape = script.byte();
        field.value_rank = static_cast<std::int32_t>(shape % 8) - 1;
        field.is_optional = (shape & 8U) != 0;
        field.max_string_length = (shape & 16U) != 0 ? 2 : 0;
        if (field.value_rank > 0 && (shape & 32U) != 0) {
            field.array_dimensions.resize(static_cast<std::size_t>(field.value_rank));
            field.array_dimensions[0] = 2;
        }
        definition.fields.push_back(std::move(field));
    }
    return {NodeId{1, number}, "S", choose_type(script), {}, script.byte() % 8 == 0, definition};
}

DataTypeEntry enumeration(Script& script, std::uint32_t number)
{
    EnumDefinition definition;
    definition.fields.resize(script.byte() % 4U);
    for (EnumField& field : definition.fields) {
        field.value = script.byte();
        field.name = "V" + std::to_string(field.value);
    }
    return {NodeId{1, number}, "E", choose_type(script), {}, false, definition};
}

/// Whatever decodes must encode, and must then decode to the same value and bytes.
void round_trip(const binary::DynamicType& type, std::span<const std::byte> input)
{
    const auto value = binary::decode_dynamic(input, type);
    if (!value) {
        return;
    }
    const binary::DynamicValue copy = *value;
    check(copy == *value);
    const auto bytes = binary::to_bytes(*value);
    check(bytes.has_value());
    check(binary::to_text(*value).size() < 10'000);
    const auto again = binary::decode_dynamic(*bytes, type);
    if (again) { // the canonical form may be larger than a limit that the input kept
        check(binary::to_bytes(*again) == bytes);
    }
}

/// The check in place refuses what the decoder refuses, and more.
void check_in_place(const binary::DynamicTypes& types, const binary::DynamicType& type,
                    std::span<const std::byte> input)
{
    const auto object = ExtensionObject::from_binary(type.encoding_id, ByteString{input});
    if (types.find_encoding(type.encoding_id) == &type &&
        binary::check_dynamic(Variant{object}, types).is_good()) {
        check(binary::decode_dynamic(input, type).has_value());
    }
}

} // namespace

/// Definitions of up to eight types that may need each other, then a value of each.
int test_one_input(const std::uint8_t* data, std::size_t size)
{
    Script script{{data, size}};
    std::vector<DataTypeEntry> entries;
    const std::uint32_t count = 1 + script.byte() % 8U;
    for (std::uint32_t number = 1; number <= count; ++number) {
        entries.push_back(script.byte() % 4 == 0 ? enumeration(script, number)
                                                 : structure(script, number));
    }
    const auto types = binary::DynamicTypes::compile(std::move(entries));
    const auto input = script.bytes(size);
    for (std::uint32_t number = 1; number <= count; ++number) {
        const binary::DynamicType* const type = types.find(NodeId{1, number});
        if (type != nullptr && type->is_structure()) {
            const binary::DynamicValue initial{*type};
            check(binary::to_bytes(initial)->size() >= type->min_wire_size);
            round_trip(*type, input);
            check_in_place(types, *type, input);
            check_in_place(types, *type, *binary::to_bytes(initial));
            round_trip(*type, *binary::to_bytes(initial));
        }
    }
    return 0;
}

} // namespace dynamic_fuzz
