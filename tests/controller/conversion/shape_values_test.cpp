#include <catch2/catch.hpp>

#include "shape_fixture.hpp"
#include "support/allocation_count.hpp"

namespace shape_values_test {

using namespace busbar;
using namespace busbar::test;

using Numbers = std::vector<std::int32_t>;

namespace {

constexpr std::array<std::uint32_t, 1> three{3};
constexpr std::array<std::uint32_t, 2> two_by_three{2, 3};
const NodeId int32{0, id::Int32};

Variant matrix(Array<std::int32_t> values, Array<std::uint32_t> dimensions)
{
    return Variant::matrix(std::move(values), std::move(dimensions));
}

} // namespace

TEST_CASE_METHOD(ShapeFixture, "8.2 Array handling: values of scalars, arrays, matrices", "[8.2]")
{
    const ValueShape scalar = shape({int32});
    CHECK(counted(scalar) == Variant{std::int32_t{1}});
    CHECK(leaves(scalar, Variant{std::int32_t{7}}) == Numbers{7});
    const ValueShape array = shape({int32, 1, three});
    CHECK(counted(array) == Variant{Array<std::int32_t>{1, 2, 3}});
    CHECK(leaves(array, Variant{Array<std::int32_t>{7, 8, 9}}) == Numbers{7, 8, 9});
    const ValueShape both = shape({int32, 2, two_by_three});
    const Variant value = matrix({1, 2, 3, 4, 5, 6}, {2, 3});
    CHECK(counted(both) == value);
    CHECK(leaves(both, value) == Numbers{1, 2, 3, 4, 5, 6});
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Write: the elements of each dimension must match", "[8.1]")
{
    const auto refused = [&](const ValueShape& made, const Variant& value) {
        return leaves(made, value).error();
    };
    const ValueShape array = shape({int32, 1, three});
    CHECK(refused(array, Array<std::int32_t>{1, 2}) == status::Bad_WriteNotSupported);
    CHECK(refused(array, Array<std::int32_t>{1, 2, 3, 4}) == status::Bad_WriteNotSupported);
    CHECK(refused(array, Array<std::int32_t>{}) == status::Bad_WriteNotSupported);
    CHECK(refused(array, matrix({1, 2, 3}, {1, 3})) == status::Bad_WriteNotSupported);
    CHECK(refused(array, std::int32_t{1}) == status::Bad_WriteNotSupported);
    CHECK(refused(array, Array<std::int16_t>{1, 2, 3}) == status::Bad_TypeMismatch);
    CHECK(refused(array, Variant{}) == status::Bad_TypeMismatch);
    const ValueShape both = shape({int32, 2, two_by_three});
    CHECK(refused(both, matrix({1, 2, 3, 4, 5, 6}, {3, 2})) == status::Bad_WriteNotSupported);
    CHECK(refused(both, Array<std::int32_t>{1, 2, 3, 4, 5, 6}) == status::Bad_WriteNotSupported);
    CHECK(refused(shape({int32}), Array<std::int32_t>{1}) == status::Bad_WriteNotSupported);
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Read: leaves without label keep their values", "[8.1]")
{
    const ValueShape array = shape({int32, 1, three});
    const auto second_only = [](std::size_t leaf, void* value) -> StatusCode {
        if (leaf == 1) {
            *static_cast<std::int32_t*>(value) = 42;
        }
        return status::Good;
    };
    const Variant before{Array<std::int32_t>{7, 8, 9}};
    CHECK(array.assemble(&before, second_only) == Variant{Array<std::int32_t>{7, 42, 9}});
    CHECK(array.assemble(nullptr, second_only) == Variant{Array<std::int32_t>{0, 42, 0}});
    const Variant other{Array<std::int32_t>{7, 8}};
    CHECK(array.assemble(&other, second_only) == Variant{Array<std::int32_t>{0, 42, 0}});
    const Variant text{"text"};
    CHECK(array.assemble(&text, second_only) == Variant{Array<std::int32_t>{0, 42, 0}});
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Read: the first leaf that fails ends it", "[8.1]")
{
    const ValueShape array = shape({int32, 1, three});
    std::size_t asked = 0;
    const auto fails = [&](std::size_t, auto*) -> StatusCode {
        return ++asked == 2 ? status::Bad_OutOfRange : status::Good;
    };
    CHECK(array.assemble(nullptr, fails).error() == status::Bad_OutOfRange);
    CHECK(asked == 2);
    asked = 0;
    CHECK(array.take_apart(Variant{Array<std::int32_t>{1, 2, 3}}, fails) == status::Bad_OutOfRange);
    CHECK(asked == 2);
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Structure assignment: values of nested structures", "[8.2]")
{
    const NodeId inner = add_structure("Inner", {field("A", int32), field("B", int32, 1, {2})});
    const NodeId outer = add_structure(
        "Outer", {field("X", int32), field("One", inner), field("Two", inner, 1, {2})});
    constexpr std::array<std::uint32_t, 1> two{2};
    const ValueShape made = shape({outer, 1, two});
    const Variant value = counted(made).value();
    Numbers expected;
    for (std::size_t i = 0; i < 2 * (1 + 3 + 6); ++i) {
        expected.push_back(static_cast<std::int32_t>(i + 1));
    }
    CHECK(leaves(made, value) == expected);

    const auto& types = data_types.of(space);
    const auto& objects_written = *value.array_if<ExtensionObject>();
    CHECK(objects_written[1].encoding_id() == types.find(outer)->encoding_id);
    const auto second = binary::decode_dynamic(objects_written[1], types).value();
    CHECK(*second.value("X") == Variant{std::int32_t{11}});
    CHECK(*second.structures("Two")->values[1].value("B") == Variant{Array<std::int32_t>{19, 20}});

    // The same with nothing filled is what it was.
    const auto untouched = [](std::size_t, void*) -> StatusCode { return status::Good; };
    CHECK(made.assemble(&value, untouched) == value);
}

TEST_CASE_METHOD(ShapeFixture, "8.2 Structure assignment: fields without leaves are kept", "[8.2]")
{
    const NodeId mode = add_enumeration("Mode", {-1, 1});
    const NodeId type = add_structure("Mixed", {field("Any", NodeId{0, id::BaseDataType}),
                                                field("A", int32), field("Mode", mode)});
    const ValueShape made = shape({type});
    CHECK(paths(made) == std::vector<std::string>{".A"});
    REQUIRE(made.kept_fields().size() == 2);
    CHECK(made.kept_fields()[0].path == ".Any");
    CHECK(number(made.kept_fields()[0].error) == number(ShapeError::AbstractType));
    CHECK(made.kept_fields()[1].path == ".Mode");
    CHECK(number(made.kept_fields()[1].error) == number(ShapeError::EnumerationMinusOne));

    const auto& types = data_types.of(space);
    binary::DynamicValue before{*types.find(type)};
    REQUIRE(before.set("Any", Variant{"kept"}));
    const Variant previous{binary::to_extension_object(before).value()};
    const Variant value = counted(made, &previous).value();
    const auto after = binary::decode_dynamic(*value.get_if<ExtensionObject>(), types).value();
    CHECK(*after.value("Any") == *before.value("Any"));
    CHECK(*after.value("A") == Variant{std::int32_t{1}});
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Write: structures of another type or size", "[8.1]")
{
    const NodeId type = add_structure("Sized", {field("B", int32, 1, {2})});
    const NodeId other = add_structure("Other", {field("B", int32, 1, {2})});
    const auto& types = data_types.of(space);
    const ValueShape made = shape({type});
    const auto written = [&](const NodeId& of, Array<std::int32_t> values) {
        binary::DynamicValue value{*types.find(of)};
        REQUIRE(value.set("B", Variant{std::move(values)}));
        return leaves(made, Variant{binary::to_extension_object(value).value()});
    };
    CHECK(written(type, {1, 2}) == Numbers{1, 2});
    CHECK(written(type, {1}).error() == status::Bad_WriteNotSupported);
    CHECK(written(type, {1, 2, 3}).error() == status::Bad_WriteNotSupported);
    CHECK(written(other, {1, 2}).error() == status::Bad_TypeMismatch);
    CHECK(leaves(made, Variant{ExtensionObject{}}).error() == status::Bad_TypeMismatch);
    const ExtensionObject cut = ExtensionObject::from_binary(
        types.find(type)->encoding_id, ByteString{std::array{std::byte{2}, std::byte{0}}});
    CHECK(leaves(made, Variant{cut}).error() == status::Bad_DecodingError);
    CHECK(leaves(made, Variant{Array<ExtensionObject>{cut}}).error() ==
          status::Bad_WriteNotSupported);
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Write: a structure of namespace 0 as a C++ object", "[8.1]")
{
    if (space.find(id::Range) == model::no_node) {
        return; // a small namespace 0
    }
    const ValueShape made = shape({NodeId{0, id::Range}});
    CHECK(paths(made) == std::vector<std::string>{".Low", ".High"});
    Range range;
    range.low = -1.5;
    range.high = 7;
    std::vector<double> found;
    CHECK(made.take_apart(Variant{ExtensionObject::from(range)},
                          [&](std::size_t, const void* value) -> StatusCode {
                              found.push_back(*static_cast<const double*>(value));
                              return status::Good;
                          }) == status::Good);
    CHECK(found == std::vector<double>{-1.5, 7});
}

TEST_CASE_METHOD(ShapeFixture, "8.1 Write: a ByteString to an array of Byte", "[8.1]")
{
    const ValueShape made = shape({NodeId{0, id::Byte}, 1, three});
    std::vector<std::uint8_t> found;
    const auto take = [&](std::size_t, const void* value) -> StatusCode {
        found.push_back(*static_cast<const std::uint8_t*>(value));
        return status::Good;
    };
    const std::array bytes{std::byte{1}, std::byte{2}, std::byte{3}};
    CHECK(made.take_apart(Variant{ByteString{bytes}}, take) == status::Good);
    CHECK(found == std::vector<std::uint8_t>{1, 2, 3});
    CHECK(made.take_apart(Variant{ByteString{std::span{bytes}.first(2)}}, take) ==
          status::Bad_WriteNotSupported);
}

TEST_CASE_METHOD(ShapeFixture, "2.1 Mapped data: 25,000 numbers take one allocation", "[2.1]")
{
    constexpr std::array<std::uint32_t, 1> many{25'000};
    const ValueShape made = shape({NodeId{0, id::Int32}, 1, many});
    const auto word =
        *controller::LabelConversion::of({BuiltInType::Int32, false}, {backend::LabelType::Word});
    std::vector<std::byte> labels(25'000 * word.label_size(), std::byte{0xFF});
    const std::size_t before = allocation_count();
    const auto value = made.assemble(nullptr, [&](std::size_t leaf, void* at) {
        return word.read(labels.data() + leaf * word.label_size(), at);
    });
    CHECK(allocation_count() == before + 1);
    REQUIRE(value.has_value());
    CHECK((*value->array_if<std::int32_t>())[24'999] == -1);
    const std::size_t then = allocation_count();
    labels.assign(labels.size(), std::byte{0});
    const StatusCode status = made.take_apart(*value, [&](std::size_t leaf, const void* at) {
        return word.write(at, labels.data() + leaf * word.label_size());
    });
    CHECK(allocation_count() == then);
    CHECK(status == status::Good);
    CHECK(labels.back() == std::byte{0xFF});
}

} // namespace shape_values_test
