#include <catch2/catch.hpp>

#include "dynamic_samples.hpp"

namespace dynamic_hostile_test {

using namespace busbar;
using namespace busbar::test;

TEST_CASE("a value cut or lengthened anywhere is refused", "[binary][dynamic]")
{
    for (const DynamicValue& value : samples()) {
        INFO(value.type().name);
        auto bytes = bytes_of(value);
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            const auto cut = decode_dynamic(std::span{bytes}.first(size), value.type());
            REQUIRE(status_of(cut) == status::Bad_DecodingError);
        }
        bytes.push_back(std::byte{0});
        CHECK(status_of(decode_dynamic(bytes, value.type())) == status::Bad_DecodingError);
    }
}

TEST_CASE("any four bytes may become any number", "[binary][dynamic]")
{
    constexpr std::uint32_t numbers[] = {0,          1,          0x7FFF,     0x10000,
                                         0x7FFFFFFF, 0x80000000, 0xFFFFFFFE, 0xFFFFFFFF};
    for (const DynamicValue& value : samples()) {
        const auto good = bytes_of(value);
        for (std::size_t at = 0; at + 4 <= good.size(); ++at) {
            for (const std::uint32_t number : numbers) {
                auto bytes = good;
                for (unsigned i = 0; i < 4; ++i) {
                    bytes[at + i] = static_cast<std::byte>(number >> (8 * i));
                }
                const auto decoded = decode_dynamic(bytes, value.type());
                const StatusCode status = status_of(decoded);
                REQUIRE((decoded || status == status::Bad_DecodingError ||
                         status == status::Bad_EncodingLimitsExceeded));
            }
        }
    }
}

TEST_CASE("what is no value of a known type is not decoded", "[binary][dynamic]")
{
    const auto error = [](const ExtensionObject& object) {
        return status_of(decode_dynamic(object, plant()));
    };
    const NodeId encoding = encoding_of(types::Empty);
    CHECK(error({}) == status::Bad_DecodingError);
    CHECK(error(ExtensionObject::from_binary(NodeId{2, 77U}, {})) == status::Bad_DecodingError);
    CHECK(error(ExtensionObject::from_id(encoding)) == status::Bad_DecodingError);
    CHECK(error(ExtensionObject::from_xml(encoding, XmlElement{"<a/>"})) ==
          status::Bad_DecodingError);
    CHECK(error(ExtensionObject::from_binary(encoding, {})) == status::Good);
    CHECK(status_of(decode_dynamic({}, *plant().find(type_id(types::Mode)))) ==
          status::Bad_DecodingError);
}

TEST_CASE("elements without bytes cannot take memory", "[binary][dynamic]")
{
    const DynamicTypes compiled = DynamicTypes::compile(
        {structure(1, "Empty", Shape::Structure, {}),
         structure(2, "Many", Shape::Structure, {field("E", type_id(1), 1)}),
         structure(3, "Matrix", Shape::Structure, {field("E", type_id(1), 2)})});
    REQUIRE(compiled.errors().empty());
    const std::vector<std::byte> many{std::byte{0xFF}, std::byte{0xFF}, std::byte{0}, std::byte{0}};
    CHECK(status_of(decode_dynamic(many, *compiled.find(type_id(2)))) ==
          status::Bad_EncodingLimitsExceeded);
    std::vector<std::byte> matrix(12);
    matrix[0] = std::byte{2};
    for (const std::size_t at : {5U, 9U}) {
        matrix[at] = std::byte{0xFF};
    }
    CHECK(status_of(decode_dynamic(matrix, *compiled.find(type_id(3)))) ==
          status::Bad_EncodingLimitsExceeded);
    std::vector<std::byte> few(4);
    few[0] = std::byte{3};
    const auto value = decode_dynamic(few, *compiled.find(type_id(2)));
    REQUIRE(value);
    CHECK(value->structures("E")->values.size() == 3);
}

TEST_CASE("at most 100 values are nested in one another within a value (Part 6, 5.1.5)",
          "[binary][dynamic]")
{
    const auto tree_of = [](int levels) {
        DynamicValue tree = make(types::Tree);
        for (int i = 1; i < levels; ++i) {
            DynamicArray children{{std::move(tree)}, {}};
            tree = make(types::Tree);
            REQUIRE(tree.set("Children", std::move(children)));
        }
        return tree;
    };
    const DynamicValue deepest = tree_of(101);
    const auto bytes = bytes_of(deepest);
    CHECK(decode_dynamic(bytes, deepest.type()).value() == deepest);
    CHECK(status_of(binary::to_bytes(tree_of(102))) == status::Bad_EncodingLimitsExceeded);
    std::vector<std::byte> deeper;
    for (int i = 0; i < 100'000; ++i) {
        for (const int byte : {255, 255, 255, 255, 1, 0, 0, 0}) {
            deeper.push_back(static_cast<std::byte>(byte));
        }
    }
    CHECK(status_of(decode_dynamic(deeper, deepest.type())) == status::Bad_EncodingLimitsExceeded);
}

TEST_CASE("a matrix has the dimensions of its field", "[binary][dynamic]")
{
    const auto matrix_of = [](std::initializer_list<std::int32_t> numbers) {
        binary::VectorSink sink;
        binary::Writer writer{sink};
        for (const std::int32_t number : numbers) {
            writer.number(number);
        }
        return sink.take(writer.written());
    };
    const DynamicTypes compiled =
        DynamicTypes::compile({structure(1, "M", Shape::Structure, {field("F", id::Int32, 2)}),
                               structure(2, "P", Shape::Structure, {field("N", id::Int32)}),
                               structure(3, "S", Shape::Structure, {field("F", type_id(2), 2)})});
    for (const std::uint32_t type : {1U, 3U}) {
        const auto decoded = [&](std::initializer_list<std::int32_t> numbers) {
            const auto value = decode_dynamic(matrix_of(numbers), *compiled.find(type_id(type)));
            if (value) {
                CHECK(bytes_of(*value) == matrix_of(numbers));
            }
            return status_of(value);
        };
        CHECK(decoded({2, 1, 2, 7, 8}) == status::Good);
        CHECK(decoded({-1}) == status::Good);
        CHECK(decoded({0}) == status::Good);
        CHECK(decoded({2, 0, 5}) == status::Good);
        CHECK(decoded({2, 1, 2, 7}) == status::Bad_DecodingError);
        CHECK(decoded({2, -1, -2, 7, 8}) == status::Bad_DecodingError);
        CHECK(decoded({1, 2, 7, 8}) == status::Bad_DecodingError);
        CHECK(decoded({3, 1, 1, 2, 7, 8}) == status::Bad_DecodingError);
        CHECK(decoded({2, 65'536, 65'536}) == status::Bad_EncodingLimitsExceeded);
    }
}

} // namespace dynamic_hostile_test
