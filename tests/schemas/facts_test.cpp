#include <fstream>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <names.hpp>
#include <schema.hpp>

// The types that the generator makes of schemas/ against facts gathered independently.
namespace busbar::generator::facts_test {

namespace {

using Json = nlohmann::json;

struct Input {
    nodeset::Document document;
    Options options;
};

Expected<Schema, Failure> load(Input& input)
{
    for (const char* part : {"Types", "Services", "Objects", "Variables1", "Variables2"}) {
        input.options.inputs.push_back(BUSBAR_SOURCE_DIR "/schemas/Opc.Ua." + std::string{part} +
                                       ".NodeSet2.xml");
        REQUIRE(input.document.load_file(input.options.inputs.back()).empty());
    }
    input.options.namespace_uri = "http://opcfoundation.org/UA/";
    return make_schema(input.document, input.options);
}

/// The C++ type that a field of the facts should have.
std::string cpp_type(const Json& fact, const Json& facts)
{
    static const std::map<std::string, std::string> numbers = {
        {"Boolean", "bool"},         {"SByte", "std::int8_t"},    {"Byte", "std::uint8_t"},
        {"Int16", "std::int16_t"},   {"UInt16", "std::uint16_t"}, {"Int32", "std::int32_t"},
        {"UInt32", "std::uint32_t"}, {"Int64", "std::int64_t"},   {"UInt64", "std::uint64_t"},
        {"Float", "float"},          {"Double", "double"}};
    if (!fact["ref"].is_null() &&
        (fact["type"] == "struct" || facts["enums"].contains(fact["ref"].get<std::string>()))) {
        const auto name = fact["ref"].get<std::string>();
        return name == "StructureType" ? "StructureDefinitionType" : type_name(name);
    }
    const auto name = fact["type"].get<std::string>();
    const auto number = numbers.find(name);
    return number == numbers.end() ? name : number->second;
}

/// Fields as text: name, type, rank, optional.
std::vector<std::string> expected_fields(const Json& structure, const Json& facts)
{
    std::vector<std::string> result;
    if (!structure["base"].is_null()) {
        result = expected_fields(facts["structs"][structure["base"].get<std::string>()], facts);
    }
    for (const Json& fact : structure["fields"]) {
        result.push_back(fact["name"].get<std::string>() + " " + cpp_type(fact, facts) +
                         (fact["array"].get<bool>() ? "[]" : "") +
                         (fact["optional"].get<bool>() ? "?" : ""));
    }
    return result;
}

std::vector<std::string> fields_of(const Type& type)
{
    std::vector<std::string> result;
    for (const StructureField& field : type.fields) {
        result.push_back(field.schema_name + " " + field.type.cpp +
                         (field.value_rank == 1 ? "[]" : "") + (field.is_optional ? "?" : ""));
    }
    return result;
}

} // namespace

TEST_CASE("Generated types are those of the specification")
{
    std::ifstream file{BUSBAR_FACTS "/types.json"};
    const Json facts = Json::parse(file);
    Input input;
    const auto schema = load(input);
    REQUIRE(schema);
    std::map<std::string, const Type*> types;
    for (const Type& type : schema->types) {
        types.emplace(type.name, &type);
    }
    for (const auto& [name, fact] : facts["structs"].items()) {
        if (name == "Union") {
            continue; // stands for any union; no type of its own
        }
        INFO(name);
        REQUIRE(types.count(type_name(name)) == 1);
        const Type& type = *types[type_name(name)];
        CHECK(type.node->id.is(fact["id"].get<std::uint32_t>()));
        const Json& encoding = fact["binaryId"];
        CHECK(type.encoding_id ==
              NodeId{0, encoding.is_null() ? 0U : encoding.get<std::uint32_t>()});
        CHECK(fields_of(type) == expected_fields(fact, facts));
    }
    for (const auto& [name, fact] : facts["enums"].items()) {
        INFO(name);
        if (name == "Enumeration" || name == "IdType" || fact["id"].is_null()) {
            continue; // written by hand, or no DataType
        }
        const std::string cpp =
            name == "StructureType" ? "StructureDefinitionType" : type_name(name);
        REQUIRE(types.count(cpp) == 1);
        const Type& type = *types[cpp];
        CHECK((type.kind == Type::Kind::OptionSet) == (fact["kind"] == "optset"));
        std::map<std::string, std::int64_t> values;
        for (const Enumerator& enumerator : type.enumerators) {
            values.emplace(enumerator.name, enumerator.value);
        }
        std::map<std::string, std::int64_t> expected;
        for (const auto& [key, value] : fact["values"].items()) {
            expected.emplace(type_name(key), value.get<std::int64_t>());
        }
        CHECK(values == expected);
    }
}

} // namespace busbar::generator::facts_test
