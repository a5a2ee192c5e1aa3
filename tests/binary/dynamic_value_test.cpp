#include <catch2/catch.hpp>

#include <limits>

#include <busbar/types/registry.hpp>
#include <busbar/types/types.hpp>

#include "dynamic_samples.hpp"

namespace dynamic_value_test {

using namespace busbar;
using namespace busbar::test;
using binary::to_text;

TEST_CASE("values of every kind survive the wire", "[binary][dynamic]")
{
    for (const DynamicValue& value : samples()) {
        INFO(value.type().name);
        const auto object = to_extension_object(value);
        REQUIRE(object);
        CHECK(object->body() == ExtensionObject::Body::Binary);
        CHECK(object->encoding_id() == value.type().encoding_id);
        const auto again = decode_dynamic(*object, plant());
        REQUIRE(again);
        CHECK(*again == value);
        CHECK(bytes_of(*again) == bytes_of(value));
        DynamicValue copy = *again;
        CHECK(copy == *again);
        copy = make(types::Empty);
        CHECK_FALSE(copy == full_part());
    }
}

TEST_CASE("optional fields are announced by the EncodingMask (Part 6, 5.2.7)", "[binary][dynamic]")
{
    DynamicValue value = make(types::Measurement);
    CHECK_FALSE(value.has("Comment"));
    CHECK(value.value("Comment") == nullptr);
    CHECK(bytes_of(value).size() == 4 + 16 + 4);
    CHECK(bytes_of(value)[0] == std::byte{0});
    REQUIRE(value.set("Trace", DynamicArray{}));
    CHECK(bytes_of(value)[0] == std::byte{2});
    REQUIRE(value.set("Comment", Variant{"c"}));
    CHECK(bytes_of(value)[0] == std::byte{3});
    REQUIRE(value.clear("Trace"));
    CHECK(bytes_of(value)[0] == std::byte{1});
    CHECK(status_of(value.clear("At")) == status::Bad_TypeMismatch);

    const DynamicType& type = value.type();
    for (unsigned bit = 2; bit < 32; ++bit) {
        auto bytes = bytes_of(make(types::Measurement));
        bytes[bit / 8] = static_cast<std::byte>(1U << bit % 8);
        CHECK(status_of(decode_dynamic(bytes, type)) == status::Bad_DecodingError);
    }
}

TEST_CASE("a union holds one field or none (Part 6, 5.2.8)", "[binary][dynamic]")
{
    DynamicValue shape = make(types::Shape);
    CHECK(shape.selected() == 0);
    CHECK(bytes_of(shape) == std::vector<std::byte>(4));
    REQUIRE(shape.set("Radius", Variant{1.0}));
    CHECK(shape.selected() == 1);
    CHECK(bytes_of(shape).size() == 12);
    REQUIRE(shape.set("Corner", point(1, 2)));
    CHECK(shape.selected() == 2);
    CHECK_FALSE(shape.has("Radius"));
    CHECK(*shape.structure("Corner") == point(1, 2));
    CHECK(status_of(shape.set("Radius", Variant{1})) == status::Bad_TypeMismatch);
    CHECK(shape.selected() == 2);
    REQUIRE(shape.clear("Corner"));
    CHECK(shape == make(types::Shape));

    for (const int selected : {4, 5, 255}) {
        std::vector<std::byte> bytes(20);
        bytes[0] = static_cast<std::byte>(selected);
        CHECK(status_of(decode_dynamic(bytes, shape.type())) == status::Bad_DecodingError);
    }
}

TEST_CASE("content of another type or shape is refused", "[binary][dynamic]")
{
    DynamicValue part = full_part();
    const DynamicValue before = part;
    const auto refused = [&](const char* name, auto content) {
        INFO(name);
        CHECK(status_of(part.set(name, std::move(content))) == status::Bad_TypeMismatch);
    };
    refused("Name", Variant{});
    refused("Name", Variant{1});
    refused("Name", Variant{Array<String>{"a"}});
    refused("Size", Variant{1.0F});
    refused("Flags", Variant{5});
    refused("Counts", Variant{std::int16_t{1}});
    refused("Counts", Variant{Array<std::int32_t>{1}});
    refused("Counts", Variant::matrix(Array<std::int16_t>{1}, {1U, 1U}));
    refused("Matrix", Variant{Array<float>{1}});
    refused("Matrix", Variant::matrix(Array<float>{1}, {1U, 1U, 1U}));
    refused("Shape", Variant{1});
    refused("Shape", point(1, 2));
    refused("Shape", Variant{to_extension_object(make(types::Shape)).value()});
    refused("Corners", point(1, 2));
    refused("Corners", DynamicArray{{make(types::Point3D)}, {}});
    refused("Corners", DynamicArray{{point(1, 2)}, {1U, 1U}});
    refused("Grid", DynamicArray{{point(1, 2)}, {}});
    refused("Grid", DynamicArray{{point(1, 2)}, {1U, 2U}});
    refused("Grid", DynamicArray{{point(1, 2)}, {1U, 1U, 1U}});
    refused("Grid", DynamicArray{{}, {UINT32_MAX, 0U}});
    refused("Matrix", Variant::matrix(Array<float>{}, {UINT32_MAX, 0U}));
    refused("Name", point(1, 2));
    CHECK(status_of(part.set("None", Variant{1})) == status::Bad_NotFound);
    CHECK(status_of(part.set(10, Variant{1})) == status::Bad_NotFound);
    CHECK(status_of(part.clear("None")) == status::Bad_NotFound);
    CHECK_FALSE(part.has("None"));
    CHECK(part.value("None") == nullptr);
    CHECK(part == before);

    DynamicValue container = full_container();
    CHECK(status_of(container.set("Amount", Variant{"7"})) == status::Bad_TypeMismatch);
    CHECK(status_of(container.set("Place", make(types::Shape))) == status::Bad_TypeMismatch);
    CHECK(container.set("Any", make(types::Shape)));
    CHECK(container.set("Amount", Variant{}));
}

TEST_CASE("a value is printed within limits", "[binary][dynamic]")
{
    CHECK(to_text(full_measurement()) ==
          R"(Measurement {At: Point {X: 1, Y: 2}, Comment: "ok", Mode: Auto (2), )"
          R"(Trace: [Point {X: 5, Y: 6}]})");
    CHECK(to_text(make(types::Shape)) == "Shape {}");
    const std::string part = to_text(full_part());
    CHECK(part.find(R"(Name: "left \"rail\"\x0A")") != std::string::npos);
    CHECK(part.find("Flags: Read | Delete (5)") != std::string::npos);
    CHECK(part.find("Grid: 2x3 [Point {X: 0, Y: ") != std::string::npos);
    CHECK(part.find(R"(Anything: ["a", null])") != std::string::npos);

    binary::TextLimits limits;
    limits.max_elements = 2;
    CHECK(to_text(Variant{Array<std::int32_t>{1, 2, 3}}, limits) == "[1, 2, ...]");
    limits.max_bytes = 20;
    CHECK(to_text(full_part(), limits).size() < 40);
    limits = {};
    limits.max_depth = 1;
    CHECK(to_text(full_measurement(), limits).find("At: Point {...}") != std::string::npos);
    CHECK(to_text(Variant{}) == "null");
    CHECK(to_text(Variant{status::Bad_Timeout}) == "Bad_Timeout");
    CHECK(to_text(Variant{LocalizedText{"en", "Go"}}) == R"("Go"@en)");
    const std::byte bytes[] = {std::byte{0x0A}, std::byte{0xFF}};
    CHECK(to_text(Variant{ByteString{std::span{bytes}}}) == "0x0AFF");
}

TEST_CASE("generated types and dynamic values convert both ways", "[binary][dynamic]")
{
    auto range_type = structure(1, "Range", Shape::Structure,
                                {field("Low", id::Double), field("High", id::Double)});
    range_type.id = NodeId{0, id::Range};
    range_type.encoding_id = NodeId{0, Range::binary_encoding_id};
    const DynamicTypes compiled = DynamicTypes::compile({range_type});
    const binary::TypeRegistry registry{binary::namespace0_types()};
    Range range;
    range.low = -1;
    range.high = 5;
    auto value = binary::to_dynamic(range, compiled);
    REQUIRE(value);
    CHECK(*value->get_if<double>("High") == 5);
    REQUIRE(value->set("High", Variant{6.0}));
    CHECK(binary::to_generated<Range>(*value, &registry)->high == 6);
    CHECK(status_of(binary::to_generated<EUInformation>(*value, &registry)) ==
          status::Bad_TypeMismatch);
    CHECK(status_of(binary::to_dynamic(EUInformation{}, compiled)) == status::Bad_DecodingError);
    CHECK(status_of(to_extension_object(make(types::Bits))) == status::Bad_EncodingError);
}

TEST_CASE("values compare by type and content", "[binary][dynamic]")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(point(nan, 1) == point(nan, 1));
    CHECK_FALSE(point(1, 2) == point(1, 3));
    DynamicValue null = make(types::Part);
    DynamicValue empty = null;
    REQUIRE(empty.set("Corners",
                      DynamicArray{Array<DynamicValue>(std::span<const DynamicValue>{}), {}}));
    CHECK_FALSE(null == empty);
    CHECK_FALSE(bytes_of(null) == bytes_of(empty));
}

} // namespace dynamic_value_test
