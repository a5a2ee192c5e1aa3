#include <catch2/catch.hpp>

#include <emit.hpp>
#include <names.hpp>
#include <schema.hpp>

namespace busbar::generator::generator_test {

namespace {

/// A nodeset of one DataType below `supertype`.
std::string failure_of(const std::string& supertype, const std::string& definition)
{
    nodeset::Document document;
    REQUIRE(document.load_file(BUSBAR_SOURCE_DIR "/schemas/Opc.Ua.Types.NodeSet2.xml").empty());
    REQUIRE(document
                .load_text("<UANodeSet><NamespaceUris><Uri>urn:t</Uri></NamespaceUris>\n"
                           "<UADataType NodeId=\"ns=1;i=1\" BrowseName=\"1:T\"><References>"
                           "<Reference ReferenceType=\"i=45\" IsForward=\"false\">" +
                               supertype + "</Reference></References>\n<Definition Name=\"T\">" +
                               definition + "</Definition></UADataType></UANodeSet>",
                           "t.xml")
                .empty());
    Options options;
    options.namespace_uri = "urn:t";
    options.cpp_namespace = "t";
    const auto schema = make_schema(document, options);
    return schema ? std::string{} : schema.error();
}

std::string field(const std::string& attributes)
{
    return "<Field Name=\"F\" " + attributes + "/>";
}

Expected<Options, Failure> parse(std::vector<std::string> arguments)
{
    std::vector<char*> pointers;
    for (std::string& argument : arguments) {
        pointers.push_back(argument.data());
    }
    return parse_options(static_cast<int>(pointers.size()), pointers.data());
}

} // namespace

TEST_CASE("Names of the specification become C++ names")
{
    CHECK(field_name("RequestedMaxReferencesPerNode") == "requested_max_references_per_node");
    CHECK(field_name("ServerCACertificate") == "server_ca_certificate");
    CHECK(field_name("NodeId") == "node_id");
    CHECK(field_name("X") == "x");
    CHECK(field_name("default") == "default_");
    CHECK(field_name("Type") == "type_");
    CHECK(field_name("a b-c") == "a_b_c");
    CHECK(type_name("3DFrame") == "ThreeDFrame");
    CHECK(type_name("") == "Unnamed");
    CHECK(in_quotes("a\"b\n1") == "\"a\\\"b\\x0a\" \"1\"");
}

TEST_CASE("What cannot be generated is said with file, line and reason")
{
    CHECK(failure_of("i=22", field("DataType=\"i=6\"")).empty());
    CHECK(failure_of("i=22", field("DataType=\"ns=1;i=9\"")) ==
          "t.xml:3: the DataType nsu=urn:t;i=9 of the field F is in none of the files");
    CHECK(failure_of("i=22", field("DataType=\"i=6\" ValueRank=\"0\"")) ==
          "t.xml:3: found ValueRank=0 of the field F, expected -1 or at least 1");
    CHECK(failure_of("i=22", field("DataType=\"ns=1;i=1\"")) ==
          "t.xml:2: the structure T contains itself other than through an array");
    CHECK(failure_of("i=22", field("DataType=\"ns=1;i=1\" ValueRank=\"1\"")).empty());
    CHECK(failure_of("i=29", field("Value=\"2147483648\"")) ==
          "t.xml:3: found Value=2147483648 of F, expected -2147483648 to 2147483647");
    CHECK(failure_of("i=3", field("Value=\"8\"")) ==
          "t.xml:3: found Value=8 of F, expected 0 to 7");
    std::string many;
    for (int i = 0; i < 33; ++i) {
        many += "<Field Name=\"F" + std::to_string(i) + "\" DataType=\"i=1\" IsOptional=\"true\"/>";
    }
    CHECK(failure_of("i=22", many) == "t.xml:2: found more than 32 optional fields");
}

TEST_CASE("The command line is checked")
{
    const auto options =
        parse({"busbar-generate", "--output", "out", "--dependency", "d.xml,d,d/types", "a.xml"});
    REQUIRE(options);
    CHECK(options->dependencies.at(0).path == "d.xml");
    CHECK(options->dependencies.at(0).include_path == "d/types");
    CHECK(options->inputs == std::vector<std::string>{"a.xml"});
    CHECK(parse({"busbar-generate", "a.xml"}).error().starts_with("--output is missing"));
    CHECK(parse({"busbar-generate", "--output"}).error().starts_with("--output needs a value"));
    CHECK(parse({"busbar-generate", "--colour"}).error().starts_with("found --colour"));
}

} // namespace busbar::generator::generator_test
