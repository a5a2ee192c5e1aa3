#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/binary/dynamic_value.hpp>
#include <busbar/model/data_types.hpp>
#include <busbar/types/registry.hpp>
#include <busbar/types/types.hpp>
#include <line/nodes.hpp>

#include "model_fixture.hpp"
#include "support/random_dynamic.hpp"

namespace busbar::model::data_types_test {

using binary::DynamicType;

namespace {

/// Decodes with the generated code and encodes again.
Result<std::vector<std::byte>> recode(const StructureType& type, std::span<const std::byte> bytes,
                                      const binary::TypeRegistry& registry)
{
    binary::Reader reader{bytes, binary::Strings::Own, &registry, binary::dynamic_decode_limits()};
    void* const object = type.create();
    type.decode(reader, object);
    binary::VectorSink sink;
    binary::Writer writer{sink};
    type.encode(writer, object);
    type.destroy(object);
    if (!reader.ok() || reader.remaining() != 0) {
        return fail(status::Bad_DecodingError);
    }
    return sink.take(writer.written());
}

/// The same structure as C++ object.
ExtensionObject decoded_object(const ExtensionObject& encoded, const binary::TypeRegistry& registry)
{
    const auto bytes = binary::to_bytes(encoded);
    return binary::from_bytes<ExtensionObject>(*bytes, &registry, binary::dynamic_decode_limits())
        .value_or(ExtensionObject{});
}

/// All ways in which a Variant can hold it, and what each is with the structure encoded.
std::vector<std::pair<Variant, Variant>> held_in_variants(const ExtensionObject& object,
                                                          const ExtensionObject& encoded)
{
    std::vector<std::pair<Variant, Variant>> result;
    const auto add = [&](auto make) { result.emplace_back(make(object), make(encoded)); };
    using Objects = Array<ExtensionObject>;
    add([](const ExtensionObject& each) { return Variant{each}; });
    add([](const ExtensionObject& each) { return Variant{Objects{each, {}, each}}; });
    add([](const ExtensionObject& each) { return Variant::matrix(Objects{each, each}, {1U, 2U}); });
    add([](const ExtensionObject& each) {
        return Variant{Array<Variant>{Variant{each}, Variant{Objects{each}}, Variant{7}}};
    });
    add([](const ExtensionObject& each) { return Variant{DataValue{Variant{each}}}; });
    add([](const ExtensionObject& each) {
        return Variant{Array<DataValue>{DataValue{Variant{each}}, DataValue{Variant{1}}}};
    });
    return result;
}

/// The messages of PubSub's JSON mapping (Part 14, 7.2.5) have no other encoding.
bool is_json_only(const binary::DataTypeEntry& entry)
{
    return entry.name.view().starts_with("Json") && entry.name.view().ends_with("Message");
}

/// The NodeIds of their EnumStrings are in none of the packages that the schema is made of.
bool has_names_without_id(const NodeId& type)
{
    return type.is(id::DeadbandType) || type.is(id::SortOrderType);
}

/// The value of EnumStrings, EnumValues or OptionSetValues.
Variant names_of(const AddressSpace& space, NodeIndex type, const binary::TypeRegistry& registry)
{
    Variant names;
    for (const char* const name : {"EnumStrings", "EnumValues", "OptionSetValues"}) {
        space.for_each_child(type, space.find(id::HasProperty), false, QualifiedName{0, name},
                             [&](NodeIndex child) {
                                 names = space.value(child, &registry);
                                 return false;
                             });
    }
    return names;
}

StructureField field(const char* name, NodeId type, std::int32_t rank = -1)
{
    StructureField result;
    result.name = name;
    result.data_type = std::move(type);
    result.value_rank = rank;
    return result;
}

} // namespace

TEST_CASE("Generated structures and their DataTypeDefinitions say the same on the wire")
{
    const AddressSpace space;
    DataTypes data_types;
    const binary::DynamicTypes& types = data_types.of(space);
    for (const binary::DefinitionError& error : types.errors()) {
        FAIL_CHECK(to_string(error));
    }
    const binary::TypeRegistry registry{binary::namespace0_types()};
    std::size_t known = 0;
    for (const StructureType* const generated : binary::namespace0_types()) {
        const DynamicType* const type = types.find_encoding(generated->binary_encoding_id.in(0));
        if (type == nullptr) {
            continue; // left out of a small namespace 0
        }
        ++known;
        INFO(generated->name);
        REQUIRE(type->id == generated->type_id.in(0));
        for (std::uint32_t seed = 0; seed < 20; ++seed) {
            const auto value = test::RandomContent{seed}.structure(*type);
            const auto bytes = binary::to_bytes(value);
            REQUIRE(bytes);
            const auto again = recode(*generated, *bytes, registry);
            REQUIRE(again);
            REQUIRE(*again == *bytes);
            REQUIRE(binary::decode_dynamic(*again, *type, binary::dynamic_decode_limits()) ==
                    value);
        }
    }
    CHECK(known >= (is_full(space) ? binary::namespace0_types().size() : 4));
}

TEST_CASE("Values convert from and to generated types, also where they hold objects")
{
    const AddressSpace space;
    DataTypes data_types;
    const binary::DynamicTypes& types = data_types.of(space);
    const binary::TypeRegistry registry{binary::namespace0_types()};
    const DynamicType* const pair = types.find(NodeId{0, id::KeyValuePair});
    const DynamicType* const item = types.find(NodeId{0, id::MonitoringParameters});
    REQUIRE((pair != nullptr || !is_full(space)));
    for (const StructureType* const generated : binary::namespace0_types()) {
        const DynamicType* const type = types.find_encoding(generated->binary_encoding_id.in(0));
        if (type == nullptr || pair == nullptr || item == nullptr) {
            continue;
        }
        INFO(generated->name);
        for (std::uint32_t seed = 0; seed < 5; ++seed) {
            const auto value = test::RandomContent{seed}.structure(*type);
            const ExtensionObject encoded = binary::to_extension_object(value).value();
            const ExtensionObject object = decoded_object(encoded, registry);
            REQUIRE(object.body() == ExtensionObject::Body::Object);
            REQUIRE(binary::decode_dynamic(object, types) == value);
            REQUIRE(binary::check_dynamic(Variant{object}, types) == status::Good);
            for (const auto& [held, same] : held_in_variants(object, encoded)) {
                KeyValuePair from;
                from.value = held;
                const auto dynamic = binary::to_dynamic(from, types);
                REQUIRE(dynamic);
                REQUIRE(*dynamic->value("Value") == same);
                REQUIRE(binary::to_generated<KeyValuePair>(*dynamic, &registry) == from);
                binary::DynamicValue made{*pair};
                REQUIRE(made.set("Value", held));
                REQUIRE(made == *dynamic);
            }
            MonitoringParameters from;
            from.filter = object;
            const auto dynamic = binary::to_dynamic(from, types);
            REQUIRE(dynamic);
            REQUIRE(binary::to_generated<MonitoringParameters>(*dynamic, &registry) == from);
            binary::DynamicValue made{*item};
            REQUIRE(made.set("Filter", Variant{object}));
            REQUIRE(made == *dynamic);
        }
    }
}

TEST_CASE("Every structure, enumeration and option set of namespace 0 has definition and names")
{
    const AddressSpace space;
    const binary::TypeRegistry registry{binary::namespace0_types()};
    std::size_t count = 0;
    for (const binary::DataTypeEntry& entry : collect_data_types(space)) {
        INFO(entry.name.view() << " " << to_string(entry.id));
        const NodeIndex node = space.find(entry.id);
        const bool is_structure = space.is_subtype_of(node, id::Structure);
        const bool is_root = entry.id.is(id::Structure) || entry.id.is(id::Enumeration);
        const auto* const names = std::get_if<EnumDefinition>(&entry.definition);
        if (is_root ||
            (!is_structure && !space.is_subtype_of(node, id::Enumeration) && names == nullptr)) {
            continue; // Part 5, 12.2: the roots have no definition, nor have simple types
        }
        ++count;
        CHECK(entry.definition.index() != 0);
        if (const auto* structure = std::get_if<StructureDefinition>(&entry.definition)) {
            CHECK((!structure->default_encoding_id.is_null() || entry.is_abstract ||
                   is_json_only(entry)));
            // A small namespace 0 leaves out encodings that nothing in it needs.
            CHECK((structure->default_encoding_id == entry.encoding_id || !is_full(space)));
            CHECK(structure->base_data_type == entry.base);
        }
        if (names != nullptr && !is_structure && !has_names_without_id(entry.id)) {
            CHECK(names_of(space, node, registry).array_size() >= names->fields.size());
        }
    }
    CHECK(count > 5);
}

TEST_CASE_METHOD(ModelFixture, "Definitions of generated nodes have the namespaces of this server")
{
    REQUIRE(space.add(line::nodes()));
    const std::uint16_t line = space.add_namespace("urn:line").value();
    REQUIRE(line != 1);
    DataTypes data_types;
    const DynamicType* const load = data_types.of(space).find(NodeId{line, 7U});
    REQUIRE(load != nullptr);
    CHECK(load == data_types.of(space).find_encoding(NodeId{line, 8U}));
    CHECK(load->fields[0].data_type == NodeId{line, 4U});
    CHECK(load->fields[0].type->values[1].name == "Closed");
    const auto attribute =
        space.attribute(space.find(NodeId{line, 7U}), AttributeId::DataTypeDefinition);
    REQUIRE(attribute);
    // What is generated is kept as its bytes.
    const auto definition = binary::from_bytes<StructureDefinition>(
        attribute->get_if<ExtensionObject>()->binary().span());
    REQUIRE(definition);
    CHECK(definition->default_encoding_id == NodeId{line, 8U});
}

TEST_CASE_METHOD(ModelFixture, "Structures and enumerations are added with all their nodes",
                 "[unit:Base Info Custom Type System]")
{
    DataTypes data_types;
    CHECK(data_types.of(space).find(NodeId{ns, "Point"}) == nullptr);

    StructureDefinition point;
    point.fields = {field("X", NodeId{0, id::Double}), field("Mode", NodeId{ns, "Mode"})};
    const auto type = add_structure_type(space, named("Point", space.find(id::Structure)), point);
    REQUIRE(type);
    // What it needs comes later.
    CHECK(data_types.of(space).find(NodeId{ns, "Point"}) == nullptr);
    EnumDefinition mode;
    mode.fields.resize(2);
    mode.fields[0].name = "Off";
    mode.fields[1].name = "On";
    mode.fields[1].value = 1;
    const auto modes =
        add_enumeration_type(space, named("Mode", space.find(id::Enumeration)), mode);
    REQUIRE(modes);
    const DynamicType* const known = data_types.of(space).find(NodeId{ns, "Point"});
    REQUIRE(known != nullptr);
    CHECK(known->encoding_id == NodeId{ns, "Point.Default Binary"});
    CHECK(known->base == data_types.of(space).find(NodeId{0, id::Structure}));
    // Other nodes do not make the types be compiled again.
    add_folder("folder", objects);
    CHECK(data_types.of(space).find(NodeId{ns, "Point"}) == known);

    CHECK(space.value(find("Mode.EnumStrings")) ==
          Variant{Array<LocalizedText>{LocalizedText{"Off"}, LocalizedText{"On"}}});
    const NodeIndex encoding = find("Point.Default Binary");
    CHECK(space.browse_name(encoding) == QualifiedName{0, "Default Binary"});
    CHECK(space.type_definition(encoding) == space.find(id::DataTypeEncodingType));
    const Variant value{binary::to_extension_object(binary::DynamicValue{*known}).value()};
    CHECK(space.check_value(value, *type, -1, {}) == status::Good);
    CHECK(space.check_value(value, *modes, -1, {}) == status::Bad_TypeMismatch);

    CHECK(status_of(add_structure_type(space, named("Point", space.find(id::Structure)), point)) ==
          status::Bad_NodeIdExists);
    CHECK(status_of(add_enumeration_type(space, named("Mode", space.find(id::Enumeration)),
                                         mode)) == status::Bad_NodeIdExists);
    // A ValueRank that was not set is 0, which would make a type that nothing can decode.
    point.fields[1].value_rank = 0;
    CHECK(status_of(add_structure_type(space, named("Flat", space.find(id::Structure)), point)) ==
          status::Bad_NodeAttributesInvalid);
    CHECK(find("Flat.Default Binary") == no_node);
    const auto base = add_structure_type(space, named("Base", space.find(id::Structure)), {}, true);
    REQUIRE(base);
    CHECK(find("Base.Default Binary") == no_node);
}

TEST_CASE_METHOD(ModelFixture, "HasEncoding leads to new Objects from DataTypes only")
{
    NewNode node = named("Default Binary", add_folder("folder", objects));
    node.reference_type = NodeId{0, id::HasEncoding};
    CHECK(status_of(space.add_object(node)) == status::Bad_ReferenceNotAllowed);
    node.parent = space.find(id::Structure);
    CHECK(status_of(space.add_variable(node, {})) == status::Bad_ReferenceNotAllowed);
    CHECK(space.add_object(node));
}

TEST_CASE_METHOD(ModelFixture, "Names go into the Property that the values ask for")
{
    EnumDefinition definition;
    definition.fields.resize(2);
    definition.fields[0].name = "Low";
    definition.fields[0].value = 1;
    definition.fields[1].name = "High";
    definition.fields[1].value = 4;
    const auto flags =
        add_enumeration_type(space, named("Flags", space.find(id::UInt16)), definition);
    REQUIRE(flags);
    CHECK(space.value(find("Flags.OptionSetValues")) ==
          Variant{Array<LocalizedText>{LocalizedText{}, LocalizedText{"Low"}, LocalizedText{},
                                       LocalizedText{}, LocalizedText{"High"}}});
    if (space.find(id::EnumValueType) == no_node) {
        return; // a small namespace 0
    }
    REQUIRE(add_enumeration_type(space, named("Level", space.find(id::Enumeration)), definition));
    const Variant values = space.value(find("Level.EnumValues"));
    REQUIRE(values.array_size() == 2);
    CHECK((*values.array_if<ExtensionObject>())[1].get_if<EnumValueType>()->value == 4);
}

} // namespace busbar::model::data_types_test
