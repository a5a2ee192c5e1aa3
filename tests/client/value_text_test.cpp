#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

#include <busbar/client/value_json.hpp>
#include <busbar/client/value_text.hpp>

#include "binary/dynamic_samples.hpp"

namespace busbar::client::value_text_test {

namespace {

using busbar::test::plant;
using busbar::test::type_id;

Variant value_of(std::string_view text, ValueType type)
{
    const auto value = parse_value(text, type);
    INFO(text << ": " << (value ? "" : value.error().message));
    REQUIRE(value);
    return *value;
}

std::string error_of(std::string_view text, ValueType type)
{
    const auto value = parse_value(text, type);
    INFO(text);
    REQUIRE_FALSE(value);
    return value.error().message;
}

const binary::DynamicType* plant_type(std::uint32_t number)
{
    return plant().find(type_id(number));
}

} // namespace

TEST_CASE("Every built-in type is read from text")
{
    using T = BuiltInType;
    CHECK(value_of("true", {T::Boolean}) == Variant{true});
    CHECK(value_of("0", {T::Boolean}) == Variant{false});
    CHECK(value_of("-128", {T::SByte}) == Variant{std::int8_t{-128}});
    CHECK(value_of("255", {T::Byte}) == Variant{std::uint8_t{255}});
    CHECK(value_of("-5", {T::Int16}) == Variant{std::int16_t{-5}});
    CHECK(value_of("65535", {T::UInt16}) == Variant{std::uint16_t{65'535}});
    CHECK(value_of("42", {T::Int32}) == Variant{42});
    CHECK(value_of("42", {T::UInt32}) == Variant{42U});
    CHECK(value_of("-9223372036854775808", {T::Int64}) == Variant{INT64_MIN});
    CHECK(value_of("18446744073709551615", {T::UInt64}) == Variant{UINT64_MAX});
    CHECK(value_of("1.5", {T::Float}) == Variant{1.5F});
    CHECK(value_of("NaN", {T::Double}) == Variant{std::numeric_limits<double>::quiet_NaN()});
    CHECK(value_of("-Infinity", {T::Double}) == Variant{-std::numeric_limits<double>::infinity()});
    CHECK(value_of("[\"as it is\"]", {T::String}) == Variant{"[\"as it is\"]"});
    CHECK(value_of("", {T::String}) == Variant{""});
    CHECK(value_of("1970-01-01T00:00:01Z", {BuiltInType::DateTime}) ==
          Variant{DateTime::from_unix_seconds(1)});
    CHECK(value_of("72962B91-FA75-4AE6-8D28-B404DC7DAF63", {BuiltInType::Guid}).type() ==
          BuiltInType::Guid);
    const std::byte bytes[] = {std::byte{0}, std::byte{255}};
    CHECK(value_of("0x00fF", {BuiltInType::ByteString}) == Variant{ByteString{bytes}});
    CHECK(value_of("AP8=", {BuiltInType::ByteString}) == Variant{ByteString{bytes}});
    CHECK(value_of("<a/>", {BuiltInType::XmlElement}) == Variant{XmlElement{"<a/>"}});
    CHECK(value_of("ns=2;s=a", {BuiltInType::NodeId}) == Variant{NodeId{2, "a"}});
    CHECK(value_of("svr=1;i=5", {BuiltInType::ExpandedNodeId}) ==
          Variant{ExpandedNodeId{NodeId{0, 5}, {}, 1}});
    CHECK(value_of("Bad_Timeout", {BuiltInType::StatusCode}) == Variant{status::Bad_Timeout});
    CHECK(value_of("0x800A0000", {BuiltInType::StatusCode}) == Variant{status::Bad_Timeout});
    CHECK(value_of("2:a:b", {BuiltInType::QualifiedName}) == Variant{QualifiedName{2, "a:b"}});
    CHECK(value_of(":b", {BuiltInType::QualifiedName}) == Variant{QualifiedName{0, ":b"}});
    CHECK(value_of("x", {BuiltInType::LocalizedText}) == Variant{LocalizedText{"x"}});
    CHECK(value_of(R"({"Locale":"en","Text":"x"})", {BuiltInType::LocalizedText}) ==
          Variant{LocalizedText{"en", "x"}});
}

TEST_CASE("A text that is no value says what was expected and found")
{
    using T = BuiltInType;
    CHECK(error_of("300", {T::Byte}) == "expected a Byte, 0 to 255, found \"300\"");
    CHECK(error_of("", {T::Int32}) == "expected an Int32, -2147483648 to 2147483647, found \"\"");
    CHECK(error_of("yes", {T::Boolean}) == "expected a Boolean, true or false, found \"yes\"");
    CHECK(error_of("\x1b[2J", {BuiltInType::Guid}).find('\x1b') == std::string::npos);
    CHECK(error_of("[1,300]", {T::Byte, 1}) == "[1]: expected a Byte, 0 to 255, found 300");
    CHECK(error_of("5", {T::Int32, 1}) == "expected a list such as [1, 2], found 5");
    CHECK(error_of("[1,2", {T::Int32, 1}) == "expected ',' or ']' at position 5");
    CHECK(error_of("[1] 2", {T::Int32, 1}) == "expected the end at position 5");
    CHECK(error_of("[[1,2],[3]]", {T::Int32, 2}) ==
          "expected a list of 2 like the others, found a list");
    CHECK(error_of("[1]", {T::Int32, 2}) == "expected lists within lists, 2 levels, found a list");
    CHECK(error_of("0x0", {BuiltInType::ByteString}).starts_with("expected a ByteString"));
    CHECK(error_of("1.5", {T::Int16}).starts_with("expected an Int16"));
    CHECK(error_of("1e999", {T::Double}).starts_with("expected a value of type Double"));
    CHECK_FALSE(parse_value(std::string(1'000, '['), {T::Int32, -2}));
    CHECK_FALSE(parse_value("x", {BuiltInType::DataValue}));
    CHECK_FALSE(parse_value(R"(["\ud800"])", {T::String, 1}));
    CHECK_FALSE(parse_value("{}", {BuiltInType::ExtensionObject}));
}

TEST_CASE("Arrays and matrices are lists")
{
    using T = BuiltInType;
    CHECK(value_of("[1, 2]", {T::Int16, 1}) == Variant{Array<std::int16_t>{1, 2}});
    CHECK(value_of("[]", {T::Int16, 1}).array_size() == 0);
    CHECK(value_of(R"(["a", null, "\u00e9\ud83d\ude00\n"])", {T::String, 1}) ==
          Variant{Array<String>{"a", String{}, "\xC3\xA9\xF0\x9F\x98\x80\n"}});
    CHECK(value_of("[\"9007199254740993\"]", {T::Int64, 1}) ==
          Variant{Array<std::int64_t>{9'007'199'254'740'993}});
    const Variant matrix = Variant::matrix(Array<float>{1, 2, 3, 4, 5, 6}, {2U, 3U});
    CHECK(value_of("[[1,2,3],[4,5,6]]", {T::Float, 2}) == matrix);
    CHECK(value_of("[[1,2,3],[4,5,6]]", {T::Float, 0}) == matrix);
    CHECK(value_of("[[1,2,3],[4,5,6]]", {T::Float, -2}) == matrix);
    CHECK(value_of("7", {T::Int32, -3}) == Variant{7});
    CHECK(value_of("[7]", {T::Int32, -3}) == Variant{Array<std::int32_t>{7}});
    CHECK(value_of("[]", {T::Int32, 2}).array_size() == 0);
    CHECK(error_of("[[7]]", {T::Int32, -3}).starts_with("[0]: expected an Int32"));
}

TEST_CASE("A value of any type has that of its text")
{
    CHECK(value_of("5", {}) == Variant{5});
    CHECK(value_of("5000000000", {}) == Variant{std::int64_t{5'000'000'000}});
    CHECK(value_of("5.0", {}) == Variant{5.0});
    CHECK(value_of("true", {}) == Variant{true});
    CHECK(value_of("null", {}).is_null());
    CHECK(value_of("five", {}) == Variant{"five"});
    CHECK(value_of("Int16:5", {}) == Variant{std::int16_t{5}});
    CHECK(value_of("http://x", {}) == Variant{"http://x"});
    CHECK(value_of("[1, 2.5]", {BuiltInType::Variant, -2}) == Variant{Array<double>{1, 2.5}});
    CHECK(value_of("Byte:[1, 2]", {BuiltInType::Variant, -2}) ==
          Variant{Array<std::uint8_t>{1, 2}});
    CHECK(value_of("[1, \"a\"]", {BuiltInType::Variant, 1}) ==
          Variant{Array<Variant>{Variant{1}, Variant{"a"}}});
    for (const char* text : {R"({"UaType":6})", R"({"UaType":26,"Value":1})", R"({"Value":1})",
                             R"({"UaType":6,"Value":[1,2],"Dimensions":[4294967295,4294967295]})",
                             R"({"UaType":6,"Value":[1,2],"Dimensions":[-1,2]})"}) {
        INFO(text);
        CHECK_FALSE(parse_value(text, {}));
    }
}

TEST_CASE("Enumerations are read and written by name or number")
{
    const ValueType mode{BuiltInType::Int32, -1, plant_type(test::types::Mode)};
    CHECK(value_of("Auto", mode) == Variant{2});
    CHECK(value_of("7", mode) == Variant{7});
    CHECK(error_of("On", mode) ==
          "expected a number or name of Mode: Off, Manual, Auto, found \"On\"");
    const ValueType flags{BuiltInType::UInt16, -1, plant_type(test::types::Flags)};
    CHECK(value_of("Read|Delete", flags) == Variant{std::uint16_t{5}});
    CHECK_FALSE(parse_value("Read|", flags));
    TextOptions options;
    options.type = mode.type;
    CHECK(to_text(Variant{2}, options) == "Auto (2)");
    CHECK(to_text(Variant{9}, options) == "9");
}

TEST_CASE("Structures survive JSON")
{
    JsonOptions json;
    json.types = &plant();
    for (const binary::DynamicValue& value : test::samples()) {
        const Variant object{binary::to_extension_object(value).value()};
        const std::string text = to_json(object, json);
        INFO(text);
        ValueType type;
        type.types = &plant();
        CHECK(value_of(text, type) == object);
    }
    // Without the types there is the body.
    const Variant object{binary::to_extension_object(test::point(1, 2)).value()};
    CHECK(value_of(to_json(object), {}) == object);
}

TEST_CASE("Structures are read by their fields' names")
{
    ValueType part{BuiltInType::ExtensionObject, -1, plant_type(test::types::Part), &plant()};
    const Variant empty{
        binary::to_extension_object(binary::DynamicValue{*plant_type(test::types::Part)}).value()};
    part.base = &empty;
    const Variant read =
        value_of(R"({"Name":"x","Flags":"Read|Write","Shape":{"Corner":{"X":1,"Y":0}},)"
                 R"("Grid":[[{"X":1,"Y":2}]]})",
                 part);
    const auto value = binary::decode_dynamic(*read.get_if<ExtensionObject>(), plant());
    REQUIRE(value);
    CHECK(*value->get_if<std::uint16_t>("Flags") == 3);
    CHECK(*value->structure("Shape")->structure("Corner")->get_if<double>("X") == 1);
    CHECK(error_of(R"({"Nam":"x"})", part) == "Part has no field Nam");
    CHECK(error_of(R"({"Corners":[{"X":1,"Y":1},{"X":"a"}]})", part) ==
          ".Corners[1].X: expected a value of type Double, found \"a\"");
    CHECK(error_of(R"({"Counts":[1,70000]})", part) ==
          ".Counts[1]: expected an Int16, -32768 to 32767, found 70000");
    CHECK(error_of(R"({"Shape":5})", part) ==
          ".Shape: expected an object with the fields of Shape, found 5");
}

TEST_CASE("A structure is refused if a field is missing")
{
    const ValueType point{BuiltInType::ExtensionObject, -1, plant_type(test::types::Point),
                          &plant()};
    CHECK(error_of(R"({"X":1})", point) == "Point is not complete, these fields are missing: Y");
    CHECK(value_of(R"({"X":1,"Y":2})", point) ==
          Variant{binary::to_extension_object(test::point(1, 2)).value()});
    ValueType points = point;
    points.value_rank = 1;
    CHECK(error_of(R"([{"X":1,"Y":2},{"Y":2}])", points) ==
          "[1]: Point is not complete, these fields are missing: X");
}

TEST_CASE("Fields that are not named are those of the base")
{
    ValueType point{BuiltInType::ExtensionObject, -1, plant_type(test::types::Point), &plant()};
    const Variant base{binary::to_extension_object(test::point(1, 2)).value()};
    point.base = &base;
    CHECK(value_of(R"({"Y":5})", point) ==
          Variant{binary::to_extension_object(test::point(1, 5)).value()});
    // Elements of arrays have to be complete even so.
    ValueType part{BuiltInType::ExtensionObject, -1, plant_type(test::types::Part), &plant()};
    const Variant empty{
        binary::to_extension_object(binary::DynamicValue{*plant_type(test::types::Part)}).value()};
    part.base = &empty;
    CHECK(error_of(R"({"Corners":[{"X":1}]})", part) ==
          ".Corners[0]: Point is not complete, these fields are missing: Y");
}

TEST_CASE("Times of IEC 61131-3 are literals")
{
    std::vector<binary::DataTypeEntry> entries;
    const auto add = [&entries](std::uint32_t id, const char* name, std::uint32_t base) {
        binary::DataTypeEntry& entry = entries.emplace_back();
        entry.id = NodeId{1, id};
        entry.name = String{name};
        entry.base = NodeId{0, base};
    };
    add(1, "TIME", id::Int64);
    add(2, "TOD", id::UInt32);
    add(3, "DATE", id::DateTime);
    add(4, "DT", id::DateTime);
    const auto types = binary::DynamicTypes::compile(std::move(entries));
    const auto round = [&types](std::uint32_t id, const char* text, std::string_view shown) {
        TextOptions options;
        options.type = types.find(NodeId{1, id});
        REQUIRE(options.type != nullptr);
        const Variant value = value_of(text, {options.type->built_in, -1, options.type, &types});
        CHECK(to_text(value, options) == shown);
        CHECK(value_of(shown, {options.type->built_in, -1, options.type, &types}) == value);
    };
    round(1, "T#1h_30m", "T#1h30m");
    round(1, "1500", "T#1s500ms");
    round(1, "-1d2ms", "T#-1d2ms");
    round(1, "0", "T#0s");
    round(2, "21600500", "TOD#06:00:00.5");
    round(2, "tod#23:59", "TOD#23:59:00");
    round(3, "D#2026-11-29", "D#2026-11-29");
    round(4, "DT#2026-11-29-06:00:01.25", "DT#2026-11-29-06:00:01.25");
    CHECK(error_of("DT#2026-11-29-06:00:00",
                   {BuiltInType::UInt32, -1, types.find(NodeId{1, 2U}), &types}) ==
          "expected a time of day such as TOD#06:00:00, found \"DT#2026-11-29-06:00:00\"");
    // What is no time of a day stays a number.
    TextOptions tod;
    tod.type = types.find(NodeId{1, 2U});
    CHECK(to_text(Variant{std::uint32_t{86'400'000}}, tod) == "86400000");
    CHECK(to_text(Variant{DateTime{}}) == "null");
}

TEST_CASE("Numbers are rounded if that is wanted")
{
    TextOptions options;
    options.limits.max_digits = 6;
    CHECK(to_text(Variant{6.113485122570561}, options) == "6.11349");
    CHECK(to_text(Variant{12345678.9}, options) == "12345679");
    CHECK(to_text(Variant{0.000123456789}, options) == "0.000123457");
    CHECK(to_text(Variant{21.5F}, options) == "21.5");
    CHECK(to_text(Variant{-0.0}, options) == "0");
    CHECK(to_text(Variant{1e20}, options) == "1e+20");
    CHECK(to_text(Variant{100.0}, options) == "100");
    CHECK(to_text(Variant{INFINITY}, options) == "inf");
}

TEST_CASE("Values are JSON for scripts")
{
    JsonOptions plain;
    plain.with_types = false;
    CHECK(to_json(Variant{5}) == R"({"UaType":6,"Value":5})");
    CHECK(to_json(Variant{5}, plain) == "5");
    CHECK(to_json(Variant{}) == "null");
    CHECK(to_json(Variant{INT64_MIN}, plain) == R"("-9223372036854775808")");
    CHECK(to_json(Variant{std::nan("")}, plain) == R"("NaN")");
    CHECK(to_json(Variant{-INFINITY}, plain) == R"("-Infinity")");
    CHECK(to_json(Variant{0.1F}, plain) == "0.1");
    CHECK(to_json(Variant{status::Bad_Timeout}, plain) ==
          R"({"Code":2148139008,"Symbol":"Bad_Timeout"})");
    CHECK(to_json(Variant{String{}}, plain) == "null");
    const Variant matrix = Variant::matrix(Array<std::int32_t>{1, 2, 3, 4}, {2U, 2U});
    CHECK(to_json(matrix) == R"({"UaType":6,"Value":[1,2,3,4],"Dimensions":[2,2]})");
    CHECK(to_json(matrix, plain) == "[[1,2],[3,4]]");
    CHECK(to_json(Variant{LocalizedText{"en", "x"}}, plain) == R"({"Locale":"en","Text":"x"})");
    const DataValue value{Variant{true}, status::Bad_Timeout, DateTime::from_unix_seconds(0)};
    CHECK(to_json(value) ==
          R"({"UaType":1,"Value":true,"Status":{"Code":2148139008,"Symbol":"Bad_Timeout"},)"
          R"("SourceTimestamp":"1970-01-01T00:00:00Z"})");
    CHECK(to_json(DataValue{}) == "{}");
    CHECK(to_json(test::point(1, 2.5)) == R"({"X":1,"Y":2.5})");
}

TEST_CASE("Hostile texts do not reach the terminal")
{
    JsonOptions plain;
    plain.with_types = false;
    CHECK(to_json(Variant{"\x1b[2J\"\\\x7f\xC2\x9B\xFF\xC3"}, plain) ==
          R"("\u001b[2J\"\\\u007f\u009b\ufffd\ufffd")");
    for (const Variant& value :
         {Variant{"\x1b"}, Variant{NodeId{1, "\x1b"}}, Variant{QualifiedName{1, "\x1b"}},
          Variant{LocalizedText{"\x1b", "\x1b"}}, Variant{XmlElement{"\x1b"}},
          Variant{ExtensionObject::from_xml(NodeId{1, "\x1b"}, XmlElement{"\x1b"})}}) {
        CHECK(to_json(value).find('\x1b') == std::string::npos);
        CHECK(to_text(value).find('\x1b') == std::string::npos);
    }
    // A Variant in a Variant, as deep as the decoder lets it come.
    Variant deep{1};
    for (int i = 0; i < 200; ++i) {
        deep = Variant{Array<Variant>{deep}};
    }
    CHECK(to_json(deep, plain).find("null") != std::string::npos);
}

TEST_CASE("Values are text for people")
{
    CHECK(to_text(DataValue{Variant{21.5}}) == "21.5");
    CHECK(to_text(DataValue{Variant{21.5}, status::Bad_Timeout, DateTime::from_unix_seconds(0)}) ==
          "21.5 (Bad_Timeout, 1970-01-01T00:00:00Z)");
    TextOptions options;
    options.types = &plant();
    const Variant object{binary::to_extension_object(test::point(1, 2)).value()};
    CHECK(to_text(object, options) == "Point {X: 1, Y: 2}");
    CHECK(to_text(object).find("Point") == std::string::npos);
}

} // namespace busbar::client::value_text_test
