#include <catch2/catch.hpp>

#include <algorithm>

#include <busbar/client/type_dictionary.hpp>

#include "dictionary_samples.hpp"

namespace busbar::client::dictionary_test {

namespace {

using Kind = DictionaryType::Kind;

Checked<TypeDictionary> parse(const std::string& xml, const DictionaryLimits& limits = {})
{
    return parse_type_dictionary(std::as_bytes(std::span{xml}), limits);
}

const DictionaryType& type_of(const TypeDictionary& dictionary, std::string_view name)
{
    const auto found = std::ranges::find(dictionary.types, name, &DictionaryType::name);
    REQUIRE(found != dictionary.types.end());
    return *found;
}

/// "a b[] c?" of a structure.
std::string fields_of(const DictionaryType& type)
{
    std::string text;
    for (const DictionaryField& field : type.fields) {
        text += (text.empty() ? "" : " ") + field.name + (field.is_array ? "[]" : "") +
                (field.is_optional ? "?" : "");
    }
    return text;
}

/// The reason why a structure of these fields cannot be used.
std::string reason_of(const std::string& fields, const std::string& attributes = "")
{
    const auto dictionary = parse(test::dictionary_of("<opc:StructuredType Name='T' " + attributes +
                                                      ">" + fields + "</opc:StructuredType>"));
    REQUIRE(dictionary);
    REQUIRE(dictionary->types.size() == 1);
    CHECK(dictionary->types[0].fields.empty() == !dictionary->types[0].reason.empty());
    return dictionary->types[0].reason;
}

} // namespace

TEST_CASE("A type dictionary says what lies in structures (Part 5, C.2)")
{
    const auto dictionary = parse(test::press_dictionary());
    REQUIRE(dictionary);
    CHECK(dictionary->namespace_uri == test::dictionary_uri);
    CHECK(dictionary->types.size() == 6);
    for (const DictionaryType& type : dictionary->types) {
        CHECK(type.reason.empty());
    }
    const DictionaryType& mode = type_of(*dictionary, "PressMode");
    CHECK(mode.kind == Kind::Enumeration);
    REQUIRE(mode.values.size() == 3);
    CHECK(mode.values[2] == std::pair<std::int64_t, std::string>{7, "Jammed"});
    CHECK(type_of(*dictionary, "Lamps").kind == Kind::Number);
    CHECK(type_of(*dictionary, "Lamps").bits == 8);
    const DictionaryType& status = type_of(*dictionary, "PressStatus");
    CHECK(status.kind == Kind::Structure);
    CHECK_FALSE(status.has_mask);
    CHECK(fields_of(status) == "Name Mode Lamps Force Path[] Counts[] Extra");
    CHECK(status.fields[3].type == DictionaryName{"http://opcfoundation.org/UA/", "Range"});
    CHECK(status.fields[4].type == DictionaryName{test::dictionary_uri, "Position"});
    const DictionaryType& report = type_of(*dictionary, "Report");
    CHECK(report.has_mask);
    CHECK(fields_of(report) == "Number Operator? Notes[]?");
    const DictionaryType& reading = type_of(*dictionary, "Reading");
    CHECK(reading.kind == Kind::Union);
    CHECK(fields_of(reading) == "Value Raw[]");
}

TEST_CASE("A union is one also where its BaseType does not say so")
{
    CHECK(reason_of("<opc:Field Name='S' TypeName='opc:UInt32'/>"
                    "<opc:Field Name='A' TypeName='opc:Int16' SwitchField='S' SwitchValue='1'/>")
              .empty());
    const auto dictionary = parse(test::dictionary_of(
        "<opc:StructuredType Name='T'><opc:Field Name='S' TypeName='opc:UInt32'/>"
        "<opc:Field Name='A' TypeName='opc:Int16' SwitchField='S' SwitchValue='1'/>"
        "</opc:StructuredType><opc:StructuredType Name='OnlyNumber'>"
        "<opc:Field Name='N' TypeName='opc:UInt32'/></opc:StructuredType>"));
    REQUIRE(dictionary);
    CHECK(type_of(*dictionary, "T").kind == Kind::Union);
    CHECK(type_of(*dictionary, "OnlyNumber").kind == Kind::Structure);
}

TEST_CASE("An array of characters is a text")
{
    const auto dictionary = parse(test::dictionary_of(
        "<opc:StructuredType Name='T'><opc:Field Name='Length' TypeName='opc:Int32'/>"
        "<opc:Field Name='Text' TypeName='opc:Char' LengthField='Length'/>"
        "</opc:StructuredType>"));
    REQUIRE(dictionary);
    CHECK(fields_of(dictionary->types[0]) == "Text");
    CHECK(dictionary->types[0].fields[0].type.name == "CharArray");
}

TEST_CASE("Layouts that OPC UA Binary does not have are named")
{
    struct Case {
        const char* fields;
        const char* reason;
    };
    const Case wrong = GENERATE(
        Case{"<opc:Field Name='B' TypeName='opc:Bit'/><opc:Field Name='X' TypeName='opc:Byte'/>",
             "field B: bits are there, and they are not the 32 of an EncodingMask"},
        Case{"<opc:Field Name='B' TypeName='opc:Bit' Length='33'/>",
             "field B: an EncodingMask has 32 bits"},
        Case{"<opc:Field Name='X' TypeName='opc:Byte'/><opc:Field Name='B' TypeName='opc:Bit'/>",
             "field B: single bits follow other fields"},
        Case{"<opc:Field Name='X' TypeName='opc:Byte' Length='4'/>",
             "field X: its length is fixed"},
        Case{"<opc:Field Name='X' TypeName='opc:Byte' Length='many'/>",
             "field X: its length is fixed"},
        Case{"<opc:Field Name='N' TypeName='opc:Byte'/>"
             "<opc:Field Name='X' TypeName='opc:Byte' LengthField='N'/>",
             "field X: its length N is not an Int32 directly before it"},
        Case{"<opc:Field Name='N' TypeName='opc:Int32'/><opc:Field Name='M' TypeName='opc:Int32'/>"
             "<opc:Field Name='X' TypeName='opc:Byte' LengthField='N'/>",
             "field X: its length N is not an Int32 directly before it"},
        Case{"<opc:Field Name='N' TypeName='opc:Int32'/>"
             "<opc:Field Name='X' TypeName='opc:Int16' LengthField='N' IsLengthInBytes='true'/>",
             "field X: its length counts bytes"},
        Case{"<opc:Field Name='X' TypeName='opc:WideChar' Terminator='0000'/>",
             "field X: its end is marked by a Terminator"},
        Case{"<opc:Field Name='A' TypeName='opc:Int16'/>"
             "<opc:Field Name='X' TypeName='opc:Int16' SwitchField='A' SwitchValue='3'/>",
             "field X: its SwitchField A is not a bit of an EncodingMask"},
        Case{"<opc:Field Name='S' TypeName='opc:UInt32'/>"
             "<opc:Field Name='A' TypeName='opc:Int16' SwitchField='S' SwitchValue='2'/>",
             "field A: expected SwitchField S and SwitchValue 1"},
        Case{"<opc:Field Name='S' TypeName='opc:UInt32'/><opc:Field Name='A' TypeName='opc:Int16' "
             "SwitchField='S' SwitchValue='1' SwitchOperand='GreaterThan'/>",
             "field A: its SwitchOperand is not Equals"},
        Case{"<opc:Field Name='A' TypeName='opc:Bit'/><opc:Field Name='B' TypeName='opc:Bit'/>"
             "<opc:Field Name='R' TypeName='opc:Bit' Length='30'/>"
             "<opc:Field Name='X' TypeName='opc:Int16' SwitchField='B'/>",
             "field X: its bit is not that of the optional field number 1"});
    CHECK(reason_of(wrong.fields) == wrong.reason);
}

TEST_CASE("A union begins with its switch")
{
    CHECK(reason_of("<opc:Field Name='A' TypeName='opc:Int16'/>", "BaseType='ua:Union'") ==
          "a Union has to begin with a UInt32");
    CHECK(reason_of("", "BaseType='ua:Union'") == "a Union has to begin with a UInt32");
}

TEST_CASE("Big-endian, opaque and oddly long types are named")
{
    const auto dictionary = parse(test::dictionary_of(
        "<opc:StructuredType Name='Big' DefaultByteOrder='BigEndian'/>"
        "<opc:OpaqueType Name='Odd' LengthInBits='24'/>"
        "<opc:EnumeratedType Name='Few' LengthInBits='3'/><opc:EnumeratedType Name='None'/>"
        "<opc:StructuredType Name='Big'/><opc:StructuredType/>"));
    REQUIRE(dictionary);
    REQUIRE(dictionary->types.size() == 4); // of two with one name the first
    CHECK(dictionary->types[0].reason == "OPC UA Binary is little-endian");
    CHECK(dictionary->types[1].reason == "it is opaque");
    CHECK(dictionary->types[2].reason == "its LengthInBits is none of 8, 16, 32 and 64");
    CHECK(dictionary->types[3].reason == "its LengthInBits is none of 8, 16, 32 and 64");
    const auto big = parse(
        test::dictionary_of("<opc:StructuredType Name='T'/>", "DefaultByteOrder='BigEndian'"));
    REQUIRE(big);
    CHECK(big->types[0].reason == "OPC UA Binary is little-endian");
}

TEST_CASE("What is no type dictionary is refused, and why is said")
{
    const auto found = [](const std::string& xml, const DictionaryLimits& limits = {}) {
        const auto dictionary = parse(xml, limits);
        return dictionary ? std::string{"a dictionary"} : dictionary.error().found;
    };
    CHECK(found("").find("it is not well-formed XML") == 0);
    CHECK(found("<a").find("it is not well-formed XML") == 0);
    CHECK(found("<schema/>") == "found <schema>, expected <TypeDictionary>");
    CHECK(found("<!DOCTYPE a [<!ENTITY b \"c\">]><TypeDictionary/>") ==
          "a DOCTYPE, which a type dictionary must not have");
    DictionaryLimits limits;
    limits.max_bytes = 100;
    CHECK(found(std::string(101, ' '), limits) == "101 bytes, of at most 100");
    limits = {};
    limits.max_types = 5;
    CHECK(found(test::press_dictionary(), limits) == "more than 5 types");
    CHECK(found("<TypeDictionary/>") == "a dictionary");
}

TEST_CASE("Types that are larger than the limits are named")
{
    DictionaryLimits limits;
    limits.max_fields = 8;
    limits.max_values = 2;
    limits.max_name_length = 9;
    const auto dictionary = parse(test::press_dictionary(), limits);
    REQUIRE(dictionary);
    CHECK(dictionary->types.size() == 5); // without PressStatus, whose name is too long
    CHECK(type_of(*dictionary, "PressMode").reason == "it has more than 2 values");
    CHECK(type_of(*dictionary, "Report").reason == "a field's name is too long");
    limits.max_name_length = 100;
    const auto other = parse(test::press_dictionary(), limits);
    REQUIRE(other);
    CHECK(type_of(*other, "PressStatus").reason == "it has more than 8 fields");
}

TEST_CASE("Every beginning of a dictionary is refused or read without harm")
{
    const std::string whole = test::press_dictionary();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        static_cast<void>(parse(whole.substr(0, size)));
    }
    std::string deep = test::dictionary_of("");
    const std::string end = "</opc:TypeDictionary>";
    deep.resize(deep.size() - end.size());
    for (int i = 0; i < 100'000; ++i) {
        deep += "<a>";
    }
    CHECK_FALSE(parse(deep));
    for (int i = 0; i < 100'000; ++i) {
        deep += "</a>";
    }
    CHECK(parse(deep + end));
}

} // namespace busbar::client::dictionary_test
