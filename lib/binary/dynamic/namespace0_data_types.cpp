#include <busbar/binary/codec.hpp>
#include <busbar/binary/dynamic_types.hpp>
#include <busbar/binary/type_registry.hpp>
#include <busbar/definitions/definitions.hpp>

namespace busbar::binary {

namespace {

constexpr const StructureType* definition_types[] = {&StructureDefinition::type,
                                                     &EnumDefinition::type};

DataTypeEntry decode_entry(Reader& reader)
{
    DataTypeEntry entry;
    Variant definition;
    decode(reader, entry.id);
    decode(reader, entry.name);
    decode(reader, entry.base);
    decode(reader, entry.encoding_id);
    decode(reader, entry.is_abstract);
    decode(reader, definition);
    const auto* const object = definition.get_if<ExtensionObject>();
    if (object == nullptr) {
        return entry;
    }
    if (const auto* const structure = object->get_if<StructureDefinition>()) {
        entry.definition = *structure;
    } else if (const auto* const names = object->get_if<EnumDefinition>()) {
        entry.definition = *names;
    }
    return entry;
}

} // namespace

std::vector<DataTypeEntry> namespace0_data_types()
{
    const TypeRegistry types{definition_types};
    const std::string_view bytes = namespace0_definitions();
    Reader reader{std::as_bytes(std::span{bytes}), Strings::Own, &types};
    std::vector<DataTypeEntry> entries(reader.number<std::uint32_t>());
    for (DataTypeEntry& entry : entries) {
        entry = decode_entry(reader);
    }
    return entries;
}

} // namespace busbar::binary
