#include <catch2/catch.hpp>

#include <limits>

#include <busbar/client/value_json.hpp>
#include <busbar/client/value_text.hpp>
#include <busbar/types/data_types.hpp>

#include "binary/dynamic_samples.hpp"

namespace busbar::client::value_json_test {

namespace {

using busbar::test::plant;
using busbar::test::type_id;

std::string plain(const Variant& value)
{
    JsonOptions options;
    options.with_types = false;
    return to_json(value, options);
}

std::string error_of(std::string_view text, ValueType type)
{
    const auto value = parse_value(text, type);
    INFO(text);
    REQUIRE_FALSE(value);
    return value.error().message;
}

ValueType structure(std::uint32_t number)
{
    return {BuiltInType::ExtensionObject, -1, plant().find(type_id(number)), &plant()};
}

} // namespace

TEST_CASE("What has no value is null in JSON")
{
    JsonOptions bare;
    bare.with_types = false;
    CHECK(to_json(DataValue{}, bare) == R"({"Value":null})");
    CHECK(to_json(DataValue{Variant{5}}, bare) == R"({"Value":5})");
    CHECK(plain(Variant{}) == "null");
    CHECK(plain(Variant{ByteString{}}) == "null");
    CHECK(plain(Variant{ExtensionObject{}}) == "null");
    CHECK(plain(Variant{LocalizedText{}}) == R"({"Text":null})");
    CHECK(plain(Variant{Array<String>{String{}, "a"}}) == R"([null,"a"])");
    CHECK(plain(Variant{Array<Variant>{Variant{}, Variant{1}}}) == "[null,1]");
    CHECK(to_json(test::make(test::types::Tree)) == R"({"Name":null,"Children":null})");
}

TEST_CASE("Values of every type are JSON")
{
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK(plain(Variant{infinity}) == R"("Infinity")");
    CHECK(plain(Variant{false}) == "false");
    CHECK(plain(Variant{UINT64_MAX}) == R"("18446744073709551615")");
    CHECK(plain(Variant{std::int8_t{-1}}) == "-1");
    const std::byte bytes[] = {std::byte{0}, std::byte{255}};
    CHECK(plain(Variant{ByteString{bytes}}) == R"("AP8=")");
    CHECK(plain(Variant{Guid::parse("72962B91-FA75-4AE6-8D28-B404DC7DAF63").value()}) ==
          R"("72962B91-FA75-4AE6-8D28-B404DC7DAF63")");
    CHECK(plain(Variant{ExpandedNodeId{NodeId{0, 5}, {}, 1}}) == R"("svr=1;i=5")");
    CHECK(plain(Variant{QualifiedName{2, "a"}}) == R"("2:a")");
    CHECK(plain(Variant{LocalizedText{"x"}}) == R"({"Text":"x"})");
    CHECK(plain(Variant{StatusCode{0x80FF'0000}}) == R"({"Code":2164195328})"); // has no name
    DiagnosticInfo nothing;
    CHECK(plain(Variant{nothing}) == "{}");
    nothing.additional_info = "why";
    CHECK(plain(Variant{nothing}) == R"({"AdditionalInfo":"why"})");
}

TEST_CASE("Structures that nobody describes are JSON as they are encoded")
{
    const Variant range{ExtensionObject::from(Range{1, 2})};
    CHECK(plain(range) ==
          R"({"UaTypeId":"i=886","UaEncoding":1,"UaBody":"AAAAAAAA8D8AAAAAAAAAQA=="})");
    const Variant xml{ExtensionObject::from_xml(NodeId{1, 5}, XmlElement{"<a/>"})};
    CHECK(plain(xml) == R"({"UaTypeId":"ns=1;i=5","UaEncoding":2,"UaBody":"<a/>"})");
    // Nor does a description help that does not fit.
    const Variant cut{
        ExtensionObject::from_binary(plant().find(type_id(test::types::Point))->encoding_id,
                                     ByteString{std::vector<std::byte>(3)})};
    JsonOptions options;
    options.with_types = false;
    options.types = &plant();
    CHECK(to_json(cut, options).find(R"("UaBody":"AAAA")") != std::string::npos);
}

TEST_CASE("JSON is no deeper than it may be")
{
    JsonOptions options;
    options.with_types = false;
    options.max_depth = 1;
    CHECK(to_json(Variant{Array<std::int32_t>{1, 2}}, options) == "[1,2]");
    CHECK(to_json(Variant{Array<Variant>{Variant{1}}}, options) == "[null]");
    options.max_depth = 0;
    CHECK(to_json(Variant{1}, options) == "null");
    CHECK(to_json(Variant{Array<std::int32_t>{1, 2}}, options) == "[null,null]");
}

TEST_CASE("Texts that are no structure say where and why")
{
    const ValueType part = structure(test::types::Part);
    CHECK(error_of(R"({"Corners":5})", part) ==
          ".Corners: expected a list such as [1, 2], found 5");
    CHECK(error_of(R"({"Grid":[{}]})", part) ==
          ".Grid: expected lists within lists, 2 levels, found a list");
    CHECK(error_of(R"({"Grid":[[{}],5]})", part) ==
          ".Grid: expected a list of 1 like the others, found 5");
    CHECK(error_of(R"({"Corners":[5]})", part) ==
          ".Corners[0]: expected an object with the fields of Point, found 5");
    CHECK(error_of(R"({"UaTypeId":5})", part) == "expected the NodeId of a type, found 5");
    CHECK(error_of(R"({"UaTypeId":"ns=1;i=4711"})", part) ==
          "expected a structure of a type that is known, found an object");
    CHECK(error_of(R"({"UaTypeId":"ns=1;i=4711","UaBody":"?"})", part) ==
          "expected a structure of a type that is known, found an object");
    CHECK(error_of("5", part) == "expected an object with the fields of Part, found \"5\"");
    // Lists may be null, as they are in a new value.
    const binary::DynamicValue fresh{*part.type};
    const Variant empty{binary::to_extension_object(fresh).value()};
    ValueType merged = part;
    merged.base = &empty;
    CHECK(parse_value(R"({"Corners":null,"Grid":null,"Counts":null})", merged) == empty);
    const Variant filled =
        parse_value(R"({"Counts":[1,2],"Corners":[{"X":1,"Y":2}]})", merged).value();
    CHECK(filled != empty);
    merged.base = &filled;
    CHECK(parse_value(R"({"Counts":null,"Corners":null})", merged) == empty);
}

TEST_CASE("Texts that are nearly a value are none")
{
    using T = BuiltInType;
    CHECK(error_of("0x0g", {T::ByteString}) ==
          "expected a ByteString in base64, or in hexadecimal after 0x, found \"0x0g\"");
    CHECK(error_of(R"({"Code":"1"})", {T::StatusCode}).starts_with("expected a StatusCode"));
    CHECK(error_of(R"({"Symbol":"Good"})", {T::StatusCode}).starts_with("expected a StatusCode"));
    CHECK(error_of("Bad_Nothing", {T::StatusCode}) ==
          "expected a StatusCode such as Bad_Timeout or 0x800A0000, found \"Bad_Nothing\"");
    CHECK(error_of("2026", {T::DateTime}) ==
          "expected a DateTime such as 2026-11-21T06:00:00Z, found \"2026\"");
    CHECK(error_of("Pump", {T::NodeId}) == "expected a NodeId such as ns=2;s=Pump, found \"Pump\"");
    CHECK(error_of("Pump", {T::ExpandedNodeId}) ==
          "expected a value of type ExpandedNodeId, found \"Pump\"");
    CHECK(error_of(R"({"Text":5})", {T::LocalizedText}) ==
          "expected a value of type LocalizedText, found an object");
    CHECK(error_of(R"({"Locale":5,"Text":"x"})", {T::LocalizedText}) ==
          "expected a value of type LocalizedText, found an object");
    CHECK(error_of("[1]", {T::Variant, -1}) == "expected a scalar, found a list");
    CHECK(error_of("[1]", {T::DataValue, 1}) ==
          "[0]: expected a type that has a text form, found 1");
    CHECK(error_of("128", {T::SByte}) == "expected an SByte, -128 to 127, found \"128\"");
    CHECK(error_of("[true]", {T::UInt16, 1}) == "[0]: expected a UInt16, 0 to 65535, found true");
    CHECK(error_of(R"({"UaType":6,"Value":[1],"Dimensions":[2,"x"]})", {}) ==
          "expected a dimension, found \"x\"");
    CHECK(error_of(R"({"UaType":6,"Value":[1],"Dimensions":[2]})", {}) ==
          "expected Dimensions whose product is the number of values, found a list");
}

TEST_CASE("What may be left out of a text is null")
{
    using T = BuiltInType;
    CHECK(parse_value("{}", {T::LocalizedText}) == Variant{LocalizedText{}});
    CHECK(parse_value(R"({"Code":2148139008,"Symbol":"x"})", {T::StatusCode}) ==
          Variant{status::Bad_Timeout});
    CHECK(parse_value(R"([null, "AP8="])", {T::ByteString, 1})->array_size() == 2);
    CHECK(parse_value("[null]", {T::ExtensionObject, 1}) ==
          Variant{Array<ExtensionObject>{ExtensionObject{}}});
    CHECK(parse_value(R"([null, 1, "a"])", {T::Variant, 1}) ==
          Variant{Array<Variant>{Variant{}, Variant{1}, Variant{"a"}}});
    CHECK(parse_value("[1, 5000000000]", {T::Variant, -2}) ==
          Variant{Array<std::int64_t>{1, 5'000'000'000}});
    CHECK(parse_value("[]", {T::Variant, -2})->type() == T::String);
}

TEST_CASE("Of an enumeration with many names a few are told")
{
    binary::DynamicType colours;
    colours.name = "Colour";
    colours.kind = binary::DynamicType::Kind::Enumeration;
    for (std::int64_t i = 0; i < 12; ++i) {
        colours.values.push_back({i, "c" + std::to_string(i)});
    }
    CHECK(error_of("blue", {BuiltInType::Int32, -1, &colours}) ==
          "expected a number or name of Colour: c0, c1, c2, c3, c4, c5, c6, c7, c8, c9, ..., "
          "found \"blue\"");
    CHECK(parse_value("c11", {BuiltInType::Int32, -1, &colours}) == Variant{11});
    // Bits that there are not.
    colours.kind = binary::DynamicType::Kind::OptionSet;
    colours.values.push_back({64, "far"});
    colours.values.push_back({-1, "low"});
    CHECK_FALSE(parse_value("c1|far", {BuiltInType::UInt64, -1, &colours}));
    CHECK_FALSE(parse_value("low", {BuiltInType::UInt64, -1, &colours}));
    CHECK(parse_value("c1|c0|c1", {BuiltInType::UInt64, -1, &colours}) ==
          Variant{std::uint64_t{3}});
}

} // namespace busbar::client::value_json_test
