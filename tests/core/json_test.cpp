#include <catch2/catch.hpp>

#include "core/json.hpp"
#include "core/json_writer.hpp"

namespace json_test {

using namespace busbar;
using detail::Json;
using detail::JsonLimits;
using detail::JsonWriter;
using detail::parse_json;

namespace {

std::string error_of(std::string_view text, const JsonLimits& limits = {})
{
    const auto json = parse_json(text, limits);
    return json ? "none" : json.error();
}

std::string repeated(std::string_view text, std::size_t count)
{
    std::string all;
    while (count-- > 0) {
        all += text;
    }
    return all;
}

} // namespace

TEST_CASE("JSON is read with its order and its texts", "[json]")
{
    const auto json = parse_json(R"( {"b": [1, -0.50e+3, true, false, null, {}], "a": "x"} )");
    REQUIRE(json);
    CHECK(json->kind == Json::Kind::Object);
    CHECK(json->names == std::vector<std::string>{"b", "a"});
    REQUIRE(json->find("a") != nullptr);
    CHECK(json->find("a")->kind == Json::Kind::String);
    CHECK(json->find("a")->text == "x");
    CHECK(json->find("c") == nullptr);
    const auto& items = json->find("b")->items;
    REQUIRE(items.size() == 6);
    CHECK(items[1].kind == Json::Kind::Number);
    CHECK(items[1].text == "-0.50e+3");
    CHECK(items[2].kind == Json::Kind::True);
    CHECK(items[3].kind == Json::Kind::False);
    CHECK(items[4].kind == Json::Kind::Null);
    CHECK(items[5].kind == Json::Kind::Object);
}

TEST_CASE("escapes of JSON stand for UTF-8", "[json]")
{
    const auto json = parse_json(R"("\"\\\/\b\f\n\r\t\u0041\u00e4\u20AC\ud83d\ude00\u0000")");
    REQUIRE(json);
    CHECK(json->text == std::string{"\"\\/\b\f\n\r\tA\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80"} + '\0');
}

TEST_CASE("JSON is read strictly", "[json]")
{
    for (const char* right : {"{}", " { } ", "[]", "0", "-0", "1e999", R"({"a":1})",
                              R"({ "a" : [ ] , "b":[{},[]],"c":-0.5e+3})", R"({"":"","a":""})",
                              R"({"a":true,"b":false,"c":null})"}) {
        CAPTURE(right);
        CHECK(parse_json(right));
    }
    for (const char* wrong : {"",
                              " ",
                              "{",
                              "}",
                              "[",
                              "]",
                              "{}{}",
                              "{}x",
                              R"({"a"})",
                              R"({"a":})",
                              R"({"a":1,})",
                              R"({,"a":1})",
                              R"({"a":1 "b":2})",
                              "01",
                              "-01",
                              "+1",
                              "1.",
                              ".5",
                              "1.e5",
                              "1e",
                              "1e+",
                              "1e5.0",
                              "inf",
                              "nan",
                              "-",
                              "-inf",
                              "0x1",
                              "1 2",
                              "tru",
                              "TRUE",
                              "[1,]",
                              "[,1]",
                              "[1 2]",
                              "\"x",
                              R"("\x")",
                              R"("\)",
                              R"("\u12")",
                              R"("\u12g4")",
                              R"("\u+123")",
                              R"("\ud800")",
                              R"("\ud800\u0041")",
                              R"("\udc00")",
                              "\"\n\"",
                              R"({"a":1,"a":2})",
                              R"({"a":1,"\u0061":2})",
                              "{a:1}",
                              "{'a':1}",
                              "{1:1}",
                              "[1}",
                              "{\"a\":1]"}) {
        CAPTURE(wrong);
        CHECK_FALSE(parse_json(wrong));
    }
    CHECK_FALSE(parse_json(std::string_view{"1\0", 2}));
    CHECK_FALSE(parse_json(std::string_view{"\"\0\"", 3}));
}

TEST_CASE("every part of a JSON text that is cut off is refused", "[json]")
{
    const std::string_view text = R"({"a":[1,{"b":"\u00e4\n"}],"c":null})";
    REQUIRE(parse_json(text));
    for (std::size_t size = 0; size < text.size(); ++size) {
        CAPTURE(size);
        CHECK_FALSE(parse_json(text.substr(0, size)));
    }
}

TEST_CASE("what is read of JSON is limited", "[json]")
{
    const JsonLimits small{40, 3, 2, 6, false};
    CHECK(parse_json("[[[1]]]", small));
    CHECK(error_of("[[[[]]]]", small) == "expected fewer levels at position 4");
    CHECK(error_of(R"({"a":{"b":{"c":{}}}})", small) == "expected fewer levels at position 16");
    CHECK(parse_json(R"({"a":1,"b":2})", small));
    CHECK(error_of(R"({"a":1,"b":2,"c":3})", small) == "expected fewer members at position 14");
    CHECK(parse_json("[1,2,3,4,5]", small));
    CHECK(error_of("[1,2,3,4,5,6]", small) == "expected fewer values at position 12");
    CHECK(parse_json(std::string(39, ' ') + "1", small));
    CHECK(error_of(std::string(40, ' ') + "1", small) == "expected a shorter text at position 1");
    CHECK_FALSE(parse_json(R"("\u0000")", small));
    CHECK_FALSE(parse_json(R"({"\u0000":1})", small));
    CHECK(parse_json(R"("\u0001")", small));

    CHECK(parse_json(repeated("[", 64) + repeated("]", 64)));
    CHECK_FALSE(parse_json(repeated("[", 65) + repeated("]", 65)));
    CHECK_FALSE(parse_json(repeated("[", 1'000'000)));
    CHECK_FALSE(parse_json(repeated("{\"a\":", 100'000)));
    CHECK_FALSE(parse_json(std::string(5U << 20U, ' ') + "1"));
}

TEST_CASE("JSON is written with its commas", "[json]")
{
    JsonWriter json;
    json.begin_object();
    json.name("a");
    json.begin_list();
    json.string("{");
    json.string("[:,");
    json.word("1");
    json.begin_list();
    json.end_list();
    json.begin_object();
    json.end_object();
    json.word("null");
    json.end_list();
    json.name("b:");
    json.word("true");
    json.end_object();
    CHECK(json.take() == R"({"a":["{","[:,",1,[],{},null],"b:":true})");
}

TEST_CASE("a JSON string is safe on a terminal and can be read back", "[json]")
{
    JsonWriter json;
    json.string(std::string{"\"\\/\n\x1b\x7f\xC3\xA4\xC2\x9B\xFF\xE2\x82"} + '\0');
    const std::string text = json.take();
    CHECK(text == "\"\\\"\\\\/\\u000a\\u001b\\u007f\xC3\xA4\\u009b\\ufffd\\ufffd\\ufffd\\u0000\"");
    const auto back = parse_json(text);
    REQUIRE(back);
    CHECK(back->text.starts_with("\"\\/\n\x1b\x7f\xC3\xA4\xC2\x9B\xEF\xBF\xBD"));
}

} // namespace json_test
